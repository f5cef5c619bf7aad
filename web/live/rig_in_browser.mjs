// Programs of the virtual rig, and a page of theirs in headless Chromium, for the tests of the pages.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { no_browser, start_browser } from '../tests/chromium.mjs';

/** Why the tests cannot run here, or false. */
export const skip = no_browser;
if (skip) console.log(skip);

export const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
/** Overrides of a study as words of a command. */
export const overrides = (...keys) => keys.flatMap((key) => ['--set', key]);

const processes = [];
let browser, page, folder;

/** A folder that is removed at the end. */
export function make_folder(name) {
  folder = mkdtempSync(join(tmpdir(), `veridyn-${name}-`));
  return folder;
}
/** Starts a command of the program: `said` is what it wrote to stderr so far, `ended` comes when it has. */
export function run(...words) {
  const p = spawn(process.env.VERIDYN, words, { stdio: ['ignore', 'ignore', 'pipe'] });
  p.said = '';
  p.stderr.on('data', (d) => (p.said += d));
  p.ended = new Promise((done) => p.on('exit', done));
  processes.push(p);
  return p;
}
/** Stops a program as soon as it says this, for as long as no SIGCONT comes: what is to be seen then stays. */
export function held_where_it_says(program, words) {
  return new Promise((done, failed) => {
    const look = () => {
      if (!program.said.includes(words)) return;
      program.stderr.off('data', look);
      program.kill('SIGSTOP');
      done();
    };
    program.stderr.on('data', look);
    program.on('exit', () => failed(new Error(`it ended without saying "${words}": ${program.said}`)));
    look();
  });
}
/** The token of a page, from what its program says when it starts. */
export async function token_of(program) {
  let token;
  for (let k = 0; k < 400 && !token; ++k) {
    token = /token: (\S+)/.exec(program.said)?.[1];
    await sleep(50);
  }
  assert.ok(token, program.said);
  return token;
}
export async function open_page(address) {
  browser = await start_browser();
  page = await browser.newPage({ viewport: { width: 1300, height: 860 } });
  await page.goto(address);
  return page;
}
/** Waits until the page shows this: a minute, on a machine that computes much else. */
export async function shows(selector, wanted) {
  const end = Date.now() + 60000;
  let text = '';
  while (Date.now() < end) {
    // What is there now: textContent() would wait half a minute for an element that has gone.
    [text = ''] = await page.locator(selector).allTextContents();
    if (wanted.test(text)) return text;
    await sleep(50);
  }
  assert.match(text, wanted);
}
/** Ends all programs and the browser. */
export async function end_all() {
  await browser?.close();
  for (const p of processes) p.kill('SIGKILL');
  if (folder) rmSync(folder, { recursive: true, force: true });
}
