// A drawing in space: which way it moves, and how a reader moves it.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { describe, test } from 'node:test';
import { skip, steps, time_series, with_browser } from './page.mjs';

const kDegree = Math.PI / 180;

describe('a scene', { skip }, () => {
  const { open_sections } = (() => {
    const tester = with_browser();
    return { open_sections: (...all) => tester.open_sections(...all) };
  })();

  const turn = (name, direction) => ({ name, unit: 'deg', turns: true, direction, scale: kDegree });
  const shift = (name, direction) => ({ name, unit: 'mm', turns: false, direction, scale: 1e-3 });
  const point = (text, x, y, z, moves = 1) => ({ kind: 'label', tone: 'body', points: [[x, y, z, moves]], size: 0, text });
  const kJoints = [shift('surge', [1, 0, 0]), shift('sway', [0, -1, 0]), shift('heave', [0, 0, 1]), turn('yaw', [0, 0, -1]), turn('pitch', [0, -1, 0]), turn('roll', [1, 0, 0])];
  // From 0 to `most` on one joint over ten seconds.
  const ramp = (joint, most, samples = steps(0, 10, 11)) => kJoints.map((each) => samples.map((t) => (each.name === joint ? (most * t) / 10 : 0)));

  const scene = (motions, rest = {}) => ({
    kind: 'scene',
    title: 'The platform',
    caption: '',
    axis: 'time',
    x: { label: 'time', unit: 's' },
    samples: steps(0, 10, 11),
    shapes: [
      point('front', 1, 0, 0), point('left', 0, 1, 0), point('right', 0, -1, 0), point('rear', -1, 0, 0),
      { kind: 'face', tone: 'ground', points: [[-1, -1, -1, 0], [1, -1, -1, 0], [1, 1, -1, 0], [-1, 1, -1, 0]], size: 0, text: '' },
      { kind: 'actuator', tone: 'link', points: [[0, 0, -1, 0], [0, 0, 0, 1]], size: 0.5, text: '' },
      { kind: 'ball', tone: 'person', points: [[0, 0, 0.4, 1]], size: 0.1, text: '' },
    ],
    joints: kJoints,
    motions,
    choice: 'algorithm',
    height: 420,
    ...rest,
  });
  const histories = () => time_series(steps(0, 10, 101), [[{ name: 'a', y: steps(0, 100, 101) }], [{ name: 'b', y: steps(5, 6, 101) }]]);
  const beside = (motions, rest) => [{ blocks: [scene(motions, rest), histories()] }];

  /** Where the labels are on the drawing [x to the right, y down]. */
  const places = (page) =>
    page.evaluate(() => Object.fromEntries([...document.querySelectorAll('.scene-drawing text')].map((each) => [each.textContent, [Number(each.getAttribute('x')), Number(each.getAttribute('y'))]])));
  const slide = (page, to) =>
    page.locator('.scene-controls input').evaluate((input, value) => {
      input.value = String(value);
      input.dispatchEvent(new Event('input', { bubbles: true }));
    }, to);
  const time_of = (page) => page.locator('.scene-controls input').evaluate((input) => Number(input.value));

  test('is seen from behind on the right, and moves the way its axes are called', async () => {
    const moved = async (joint, most) => {
      const { page, close } = await open_sections(beside([{ name: 'a', values: ramp(joint, most) }]));
      const before = await places(page);
      await slide(page, 10);
      const after = await places(page);
      await close();
      return { before, by: (label) => [after[label][0] - before[label][0], after[label][1] - before[label][1]] };
    };
    const roll = await moved('roll', 20);
    assert.ok(roll.before.right[0] > roll.before.left[0], 'right is at the right');
    assert.ok(roll.before.front[1] < roll.before.rear[1], 'front is away');
    assert.ok(roll.by('right')[1] > 10 && roll.by('left')[1] < -10, 'roll: right side down');
    const pitch = await moved('pitch', 20);
    assert.ok(pitch.by('front')[1] < -10 && pitch.by('rear')[1] > 10, 'pitch: nose up');
    const yaw = await moved('yaw', 20);
    assert.ok(yaw.by('front')[0] > 10 && yaw.by('rear')[0] < -10, 'yaw: nose to the right');
    const heave = await moved('heave', 300);
    assert.ok(heave.by('front')[1] < -10 && Math.abs(heave.by('front')[0]) < 10, 'heave: up');
    const sway = await moved('sway', 300);
    assert.ok(sway.by('front')[0] > 10, 'sway: to the right');
    const surge = await moved('surge', 300);
    assert.ok(surge.by('left')[1] < -3, 'surge: away');
  });

  test('turns a pitched platform about its own roll axis: yaw, pitch, roll', async () => {
    // Pitched by 90 degrees and rolled by 90: what was right points backward, what was left forward.
    const values = kJoints.map((each) => [0, each.name === 'pitch' || each.name === 'roll' ? 90 : 0]);
    const { page, close } = await open_sections([{ blocks: [scene([{ name: 'a', values }], { samples: [0, 10], shapes: [point('left', 0, 1, 0), point('right', 0, -1, 0), point('ahead', 1, 0, 0, 0), point('behind', -1, 0, 0, 0), point('below', 0, 0, -1, 0)] })] }]);
    await slide(page, 10);
    const at = await places(page);
    assert.deepEqual(at.left, at.behind);
    assert.deepEqual(at.right, at.ahead);
    await close();
  });

  test('marks its time in the histories, and follows the pointer there', async () => {
    const { page, close } = await open_sections(beside([{ name: 'a', values: ramp('roll', 20) }]));
    assert.equal(await page.locator('.moment').count(), 0, 'nothing is marked before the reader asks');
    await slide(page, 4);
    const shares = await page.evaluate(() =>
      [...document.querySelectorAll('.u-over')].map((over) => {
        const line = over.querySelector('.moment').getBoundingClientRect();
        const box = over.getBoundingClientRect();
        return (line.left - box.left) / box.width;
      }),
    );
    for (const share of shares) assert.ok(Math.abs(share - 0.4) < 0.01, String(shares));
    assert.match(await page.locator('.scene-clock').innerText(), /^4(\.0*)? s$/);
    assert.deepEqual((await page.locator('.scene-values dd').allInnerTexts()).at(-1), '8.0');

    const box = await page.locator('.u-over').first().boundingBox();
    await page.mouse.move(box.x + 0.7 * box.width, box.y + 10);
    await page.waitForTimeout(100);
    assert.ok(Math.abs((await time_of(page)) - 7) < 0.1);
    await page.mouse.move(5, 5);
    await page.waitForTimeout(100);
    assert.ok(Math.abs((await time_of(page)) - 7) < 0.1, 'it stays there');
    await close();
  });

  test('leaves the mark where it belongs when the histories are zoomed', async () => {
    const { page, close } = await open_sections(beside([{ name: 'a', values: ramp('roll', 20) }]));
    await slide(page, 4);
    const over = page.locator('.u-over').first();
    const box = await over.boundingBox();
    const y = box.y + box.height / 2;
    await page.mouse.move(box.x + 0.3 * box.width, y);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.6 * box.width, y, { steps: 6 });
    await page.mouse.up();
    await slide(page, 4.5);
    await page.waitForTimeout(150);
    const at = () =>
      over.evaluate((element) => {
        const { uplot } = element.closest('.plot');
        const line = element.querySelector('.moment');
        return line.hidden ? null : uplot.posToVal(line.getBoundingClientRect().left - element.getBoundingClientRect().left, 'x');
      });
    assert.ok(Math.abs((await at()) - 4.5) < 0.05, String(await at()));
    await slide(page, 9);
    assert.equal(await at(), null, 'out of sight');
    await over.dblclick();
    await page.mouse.move(5, 5);
    await slide(page, 9);
    await page.waitForTimeout(150);
    assert.ok(Math.abs((await at()) - 9) < 0.1);
    await close();
  });

  test('plays as fast as the clock, stops at the end and begins again', async () => {
    const { page, close } = await open_sections(beside([{ name: 'a', values: ramp('roll', 20) }]));
    const button = page.locator('.play');
    assert.equal(await button.getAttribute('aria-label'), 'Play');
    await button.click();
    await page.waitForFunction(() => Number(document.querySelector('.scene-controls input').value) > 0.4);
    assert.equal(await button.getAttribute('aria-label'), 'Pause');
    await button.click();
    const paused = await time_of(page);
    await page.waitForTimeout(200);
    assert.equal(await time_of(page), paused);
    await slide(page, 9.7);
    await button.click();
    await page.waitForFunction(() => Number(document.querySelector('.scene-controls input').value) === 10);
    assert.equal(await button.getAttribute('aria-label'), 'Play');
    await button.click();
    await page.waitForFunction(() => Number(document.querySelector('.scene-controls input').value) < 5);
    await button.click();
    await close();
  });

  test('shows one algorithm at a time', async () => {
    const { page, close } = await open_sections(beside([{ name: 'calm', values: ramp('roll', 0) }, { name: 'bold', values: ramp('roll', 20) }]));
    await slide(page, 10);
    const calm = await places(page);
    await page.getByLabel('algorithm').selectOption('bold');
    const bold = await places(page);
    assert.ok(bold.right[1] > calm.right[1] + 10);
    assert.equal((await page.locator('.scene-values dd').allInnerTexts()).at(-1), '20.0');
    await close();
  });

  test('is turned by the pointer and by keys, its time by keys too', async () => {
    const { page, close } = await open_sections(beside([{ name: 'a', values: ramp('roll', 20) }]));
    const first = await places(page);
    const drawing = page.locator('.scene-drawing');
    const box = await drawing.boundingBox();
    await page.mouse.move(box.x + 100, box.y + 100);
    await page.mouse.down();
    await page.mouse.move(box.x + 160, box.y + 100, { steps: 3 });
    await page.mouse.up();
    const dragged = await places(page);
    assert.ok(dragged.rear[0] > first.rear[0] + 10, 'what is near goes with the pointer');
    await drawing.focus();
    await page.keyboard.press('Home');
    assert.deepEqual(await places(page), first);
    await page.keyboard.press('ArrowUp');
    const above = await places(page);
    assert.ok(above.rear[1] - above.front[1] > first.rear[1] - first.front[1], 'from higher up');
    for (let k = 0; k < 12; ++k) await page.keyboard.press('ArrowUp');
    const top = await places(page);
    assert.ok(top.rear[1] > top.front[1], 'not over the top');
    await page.locator('.scene-controls input').focus();
    await page.keyboard.press('ArrowRight');
    assert.ok(Math.abs((await time_of(page)) - 0.05) < 1e-6);
    await close();
  });

  test('stands beside the histories where there is room, above them on a phone and on paper', async () => {
    const box = (page, selector) => page.locator(selector).boundingBox();
    const { page, close } = await open_sections(beside([{ name: 'a', values: ramp('roll', 20) }]));
    assert.ok((await box(page, '.scene-figure')).x + (await box(page, '.scene-figure')).width <= (await box(page, 'figure.series')).x);
    await page.setViewportSize({ width: 400, height: 800 });
    await page.waitForTimeout(100);
    const [drawing, series] = [await box(page, '.scene-figure'), await box(page, 'figure.series')];
    assert.ok(drawing.y + drawing.height <= series.y);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    await page.setViewportSize({ width: 1280, height: 900 });
    await page.emulateMedia({ media: 'print' });
    await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
    await page.waitForTimeout(100);
    const [paper, below] = [await box(page, '.scene-figure'), await box(page, 'figure.series')];
    assert.ok(paper.y + paper.height <= below.y);
    assert.ok(await page.locator('.scene-drawing').isVisible());
    assert.ok(!(await page.locator('.play').isVisible()));
    await close();
  });

  test('is drawn within its frame, in colours of the theme, and saved as it stands', async () => {
    const { page, close } = await open_sections(beside([{ name: 'a', values: ramp('roll', 20) }]), { colorScheme: 'dark' });
    const inside = await page.evaluate(() => {
      const frame = document.querySelector('.scene-drawing').getBoundingClientRect();
      return [...document.querySelectorAll('.scene-drawing > :not(text)')].every((each) => {
        const box = each.getBoundingClientRect();
        return box.left >= frame.left && box.right <= frame.right && box.top >= frame.top && box.bottom <= frame.bottom;
      });
    });
    assert.ok(inside);
    const colour = () => page.locator('.scene-ball').evaluate((ball) => getComputedStyle(ball).fill);
    const dark = await colour();
    await page.locator('#theme').click();
    assert.notEqual(await colour(), dark);
    const [saved] = await Promise.all([page.waitForEvent('download'), page.getByLabel('Save The platform as SVG').click()]);
    const text = readFileSync(await saved.path(), 'utf8');
    assert.match(text, /<circle/);
    assert.ok(!/NaN|undefined|var\(/.test(text));
    await close();
  });

  test('bears one sample, none, and numbers that are missing', async () => {
    for (const samples of [[], [3], [0, 1, 2]]) {
      const values = kJoints.map(() => samples.map((t) => (t === 1 ? null : 0)));
      const { page, close } = await open_sections([{ blocks: [scene([{ name: 'a', values }], { samples })] }]);
      await slide(page, 1);
      const at = await places(page);
      assert.ok(Object.values(at).flat().every(Number.isFinite), JSON.stringify(at));
      await close();
    }
  });
});
