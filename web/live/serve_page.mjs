// `veridyn serve` in headless Chromium: a live run of the virtual rig is followed by its recording and stopped from the page, then
// looked back at; progress of an identification is shown while it computes.
//   node --test serve_page.mjs     VERIDYN=the program, STUDY=live.toml, WORK=posterior_arm.toml
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { end_all, held_where_it_says, make_folder, open_page, overrides, run, shows, skip, sleep, token_of } from './rig_in_browser.mjs';

const port = 35000 + 3 * (process.pid % 5000);
const sets = overrides(
  `live.telemetry=127.0.0.1:${port}`,
  `live.platform=127.0.0.1:${port + 1}`,
  `live.page=127.0.0.1:${port + 3}`,
  'live.signs=while',
  'live.soft_start=1',
  'live.rate=500',
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
  // As fast as time, and evenly, not in the blocks in which it is written: in one stretch at least, since a machine that computes
  // other things may hold it up.
  const followed = ({ rate, moments, looks }) => rate > 0.6 && rate < 1.4 && moments > 0.4 * looks;
  const stretches = [];
  for (let k = 0; k < 5 && !stretches.some(followed); ++k) {
    const [begun, first, seen] = [Date.now(), await clock(), new Set()];
    let looks = 0;
    for (; Date.now() < begun + 2000 || looks < 10; await sleep(50), ++looks) seen.add(await page.textContent('#clock'));
    stretches.push({ rate: (1000 * ((await clock()) - first)) / (Date.now() - begun), moments: seen.size, looks });
  }
  assert.ok(stretches.some(followed), `seconds of the run a second, moments seen in so many looks: ${JSON.stringify(stretches)}`);
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
  await shows('#state', /running/);
  await page.click('#now');
  let behind = Infinity;
  for (let k = 0; k < 100 && !(behind < 1.2); ++k) {
    await sleep(100);
    const [at, length] = (await page.textContent('#clock')).match(/[0-9.]+/g).map(Number);
    behind = length - at;
  }
  assert.ok(behind < 1.2, `${behind} s behind`);
});

test('the emergency stop needs the token, and then stops the run', { skip }, async () => {
  await page.click('#stop');
  await shows('#answer', /needs the token/);
  await shows('#why', /1 control refused/);
  await page.fill('#token', token);
  await page.click('#stop');
  await shows('#state', /stopped/);
  rig.kill('SIGINT');
  await rig.ended;
  await shows('#why', /this run is over/);
  assert.equal(await page.isDisabled('#stop'), true);
});

test('the progress of an identification is shown while it computes', { skip }, async () => {
  // A short one, held where the page is looked at: however slow the machine, the page need not keep up with it.
  const identify = run('identify', process.env.WORK, '--set', 'identify.posterior.steps=20', '--threads', '1', '--out', join(folder, 'identify'));
  const work = '.work:has-text("identify")';
  for (const [stage, number] of [['estimating 3 parameters', 4], ['posterior of 3 parameters', 5]]) {
    await held_where_it_says(identify, stage);
    await shows(`${work} .stage`, new RegExp(`${stage}.* stage ${number}`));
    await shows(`${work} .head`, /posterior_arm.toml: goes on/);
    assert.equal(await page.locator(`${work} progress`).count(), 1);
    identify.kill('SIGCONT');
  }
  assert.equal(await identify.ended, 0, identify.said);
  await shows(`${work} .head`, /: done/);
  assert.equal(await page.locator(`${work} .stage`).count(), 0);
});
