// `veridyn serve` in headless Chromium: a live run of the virtual rig is followed by its recording and stopped from the page, then
// looked back at; progress of an identification is shown while it computes.
//   node --test serve_page.mjs     VERIDYN=the program, STUDY=live.toml, WORK=posterior_arm.toml, whose stages last long enough to be seen
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { end_all, make_folder, open_page, overrides, run, shows, skip, sleep, token_of } from './rig_in_browser.mjs';

const port = 35000 + 3 * (process.pid % 5000);
const sets = overrides(
  `live.telemetry=127.0.0.1:${port}`,
  `live.platform=127.0.0.1:${port + 1}`,
  `live.page=127.0.0.1:${port + 3}`,
  'live.signs=while',
  'live.soft_start=1',
  'live.rate=500',
  'drive.duration=30',
);
let page, folder, token, rig;

const clock = async () => parseFloat(await page.textContent('#clock'));

before(async () => {
  if (skip) return;
  folder = make_folder('serve');
  mkdirSync(join(folder, 'identify'));
  const serve = run('serve', folder, '--page', `127.0.0.1:${port + 2}`);
  run('rig', 'platform', process.env.STUDY, ...sets);
  run('rig', 'vehicle', process.env.STUDY, ...sets);
  rig = run('cue', process.env.STUDY, '--live', '--start', '--out', join(folder, 'run'), ...sets);
  token = await token_of(serve);
  page = await open_page(`http://127.0.0.1:${port + 2}/`);
});

after(end_all);

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
  const identify = run('identify', process.env.WORK, '--quiet', '--out', join(folder, 'identify'));
  const work = '.work:has-text("identify")';
  await shows(`${work} .head`, /posterior_arm.toml: goes on/);
  const stages = new Set();
  while (identify.exitCode === null) {
    stages.add(await page.textContent(`${work} .stage`).catch(() => ''));
    await sleep(20);
  }
  assert.equal(identify.exitCode, 0, identify.said);
  assert.ok(stages.size > 3, [...stages].join('; '));
  await shows(`${work} .head`, /: done/);
});
