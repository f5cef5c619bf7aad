// `veridyn serve` in headless Chromium: a live run of the virtual rig is followed by its recording and stopped from the page, then
// looked back at; progress of an identification is shown while it computes.
//   node --test serve_page.mjs     VERIDYN=the program, STUDY=live.toml, FLIGHT=simulated_flight.toml
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { chromium } from 'playwright-core';

const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
const skip = existsSync(executablePath) ? false : `no Chromium at ${executablePath}`;
if (skip) console.log(skip);

const port = 35000 + 3 * (process.pid % 5000);
const sets = [`live.telemetry=127.0.0.1:${port}`, `live.platform=127.0.0.1:${port + 1}`, `live.page=127.0.0.1:${port + 3}`, 'live.signs=while', 'live.soft_start=1', 'live.rate=500', 'drive.duration=30'].flatMap((s) => ['--set', s]);
const processes = [];
let browser, page, folder, token, rig;

const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
function run(...words) {
  const p = spawn(process.env.VERIDYN, words, { stdio: ['ignore', 'ignore', 'pipe'] });
  p.said = '';
  p.stderr.on('data', (d) => (p.said += d));
  p.ended = new Promise((done) => p.on('exit', done));
  processes.push(p);
  return p;
}
/** Waits until the page shows this. */
async function shows(selector, wanted, ms = 20000) {
  const end = Date.now() + ms;
  let text = '';
  while (Date.now() < end) {
    text = (await page.textContent(selector).catch(() => '')) ?? '';
    if (wanted.test(text)) return text;
    await sleep(50);
  }
  assert.match(text, wanted);
}
const clock = async () => parseFloat(await page.textContent('#clock'));

before(async () => {
  if (skip) return;
  folder = mkdtempSync(join(tmpdir(), 'veridyn-serve-'));
  mkdirSync(join(folder, 'identify'));
  const serve = run('serve', folder, '--page', `127.0.0.1:${port + 2}`);
  run('rig', 'platform', process.env.STUDY, ...sets);
  run('rig', 'vehicle', process.env.STUDY, ...sets);
  rig = run('cue', process.env.STUDY, '--live', '--start', '--out', join(folder, 'run'), ...sets);
  for (let k = 0; k < 400 && !token; ++k) {
    token = /token: (\S+)/.exec(serve.said)?.[1];
    await sleep(50);
  }
  assert.ok(token, serve.said);
  browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--disable-gpu', '--no-first-run'] });
  page = await browser.newPage({ viewport: { width: 1300, height: 860 } });
  await page.goto(`http://127.0.0.1:${port + 2}/`);
});

after(async () => {
  await browser?.close();
  for (const p of processes) p.kill('SIGKILL');
  if (folder) rmSync(folder, { recursive: true, force: true });
});

test('a run is found as it begins and followed as its recording grows', { skip }, async () => {
  await shows('#state', /running/);
  const first = await clock();
  await sleep(2000);
  const passed = (await clock()) - first;
  assert.ok(passed > 1.2 && passed < 2.8, `${passed} s of the run in 2 s`);
  // Evenly, not in the blocks in which it is written.
  const seen = new Set();
  for (let k = 0; k < 20; ++k) {
    seen.add(await page.textContent('#clock'));
    await sleep(50);
  }
  assert.ok(seen.size > 8, [...seen].join());
  assert.equal(await page.isVisible('#start'), false);
});

test('any moment of it can be looked at again while it goes on', { skip }, async () => {
  await page.$eval('#moment', (slider) => {
    slider.value = 0;
    slider.dispatchEvent(new Event('input'));
  });
  await shows('#state', /parked/);
  await shows('#why', /looking back/);
  await page.click('#play');
  await shows('#state', /soft start/);
  await shows('#state', /running/);
  await page.click('#now');
  await sleep(300);
  const [at, length] = (await page.textContent('#clock')).match(/[0-9.]+/g).map(Number);
  assert.ok(length - at < 1.2, `${at} of ${length}`);
});

test('the emergency stop needs the token, and then stops the run', { skip }, async () => {
  await page.click('#stop');
  await shows('#answer', /needs the token/);
  await shows('#why', /1 control refused/);
  await page.fill('#token', token);
  await page.click('#stop');
  await shows('#state', /stopped/, 3000);
  rig.kill('SIGINT');
  await rig.ended;
  await shows('#why', /this run is over/);
  assert.equal(await page.isDisabled('#stop'), true);
});

test('the progress of an identification is shown while it computes', { skip }, async () => {
  const identify = run('identify', process.env.FLIGHT, '--quiet', '--out', join(folder, 'identify'));
  const work = '.work:has-text("identify")';
  await shows(`${work} .head`, /simulated_flight.toml: goes on/);
  const stages = new Set();
  while (identify.exitCode === null) {
    stages.add(await page.textContent(`${work} .stage`).catch(() => ''));
    await sleep(100);
  }
  assert.equal(identify.exitCode, 0, identify.said);
  assert.ok(stages.size > 3, [...stages].join('; '));
  await shows(`${work} .head`, /: done/);
});
