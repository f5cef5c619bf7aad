// Programs of the virtual rig, and a page of theirs in headless Chromium, for the tests of the pages.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
/** Why the tests cannot run here, or false. */
export const skip = existsSync(executablePath) ? false : `no Chromium at ${executablePath}`;
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
  browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--disable-gpu', '--no-first-run'] });
  page = await browser.newPage({ viewport: { width: 1300, height: 860 } });
  await page.goto(address);
  return page;
}
/** Waits until the page shows this. */
export async function shows(selector, wanted, ms = 20000) {
  const end = Date.now() + ms;
  let text = '';
  while (Date.now() < end) {
    text = (await page.textContent(selector).catch(() => '')) ?? '';
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
