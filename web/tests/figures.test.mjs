// What a figure does with awkward data, and what a reader can do with a figure.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { describe, test } from 'node:test';
import { skip, steps, time_series, with_browser } from './page.mjs';

describe('a figure', { skip }, () => {
  const { open_sections, open_lead } = (() => {
    const tester = with_browser();
    return {
      open_sections: (...all) => tester.open_sections(...all),
      open_lead: (sections, lead) => tester.open_sections(sections, {}, '', lead),
    };
  })();
  const one = (block) => [{ blocks: [block] }];
  const scale = (page, axis, plot = 0) =>
    page.evaluate(([a, k]) => {
      const { min, max } = document.querySelectorAll('.plot')[k].uplot.scales[a];
      return [min, max];
    }, [axis, plot]);
  const plot_box = (page, plot = 0) => page.locator('.u-over').nth(plot).boundingBox();
  const hover = async (page, share, plot = 0) => {
    const box = await plot_box(page, plot);
    await page.mouse.move(box.x + share * box.width, box.y + 0.5 * box.height);
    await page.waitForTimeout(100);
  };
  const drag = async (page, from, to) => {
    const box = await plot_box(page);
    const at = ([x, y]) => [box.x + x * box.width, box.y + y * box.height];
    await page.mouse.move(...at(from));
    await page.mouse.down();
    await page.mouse.move(...at([(from[0] + to[0]) / 2, (from[1] + to[1]) / 2]), { steps: 4 });
    await page.mouse.move(...at(to), { steps: 4 });
    await page.mouse.up();
    await page.waitForTimeout(150);
  };

  test('of the first screen stand side by side between verdict and facts', async () => {
    const x = steps(0, 10, 50);
    const lead = [time_series(x, [[{ name: 'a', y: x }]]), time_series(x, [[{ name: 'b', y: x }]])];
    const { page, close } = await open_lead(one({ kind: 'paragraph', text: 'later', tone: 'plain' }), lead);
    const [verdict, first, second, section] = await Promise.all(
      ['.verdict', '.lead figure:nth-child(1)', '.lead figure:nth-child(2)', '#section-0'].map((name) => page.locator(name).boundingBox()),
    );
    assert.ok(verdict.y + verdict.height <= first.y && first.y + first.height <= section.y);
    assert.equal(first.y, second.y);
    assert.ok(first.x + first.width <= second.x);
    await close();
  });

  test('writes no label of a region over another', async () => {
    const x = steps(0, 10, 50);
    const spans = [
      { from: 0, to: 6, label: 'longitudinal identification', tone: 'primary' },
      { from: 0.5, to: 9, label: 'lateral identification', tone: 'primary' },
      { from: 6, to: 10, label: 'hold-out', tone: 'secondary' },
    ];
    const { page, close } = await open_sections(one(time_series(x, [[{ name: 'a', y: x }]], { spans })));
    const labels = await page.evaluate(async () => {
      const { uplot } = document.querySelector('.plot');
      const seen = [];
      const write = CanvasRenderingContext2D.prototype.fillText;
      CanvasRenderingContext2D.prototype.fillText = function (text, left, top) {
        if (/identification|hold-out/.test(text)) seen.push({ text, left, top, right: left + this.measureText(text).width });
        write.call(this, text, left, top);
      };
      uplot.redraw(false);
      await new Promise((done) => setTimeout(done, 100));
      CanvasRenderingContext2D.prototype.fillText = write;
      return seen;
    });
    assert.equal(labels.length, 3, JSON.stringify(labels));
    for (const a of labels)
      for (const b of labels)
        if (a !== b && a.top === b.top) assert.ok(a.right <= b.left || b.right <= a.left, `${a.text} over ${b.text}`);
    await close();
  });

  test('shows a time of every window of a broken abscissa', async () => {
    const x = steps(0, 100, 500);
    const windows = [{ from: 1, to: 4 }, { from: 50, to: 53.9 }, { from: 96.2, to: 99.8 }];
    const { page, close } = await open_sections(one(time_series(x, [[{ name: 'a', y: x }]], { windows })), { viewport: { width: 480, height: 800 } });
    await page.waitForTimeout(200);
    const labels = await page.evaluate(() => [...document.querySelectorAll('.plot')].flatMap(({ uplot }) => uplot.axes[0]._values));
    for (const { from, to } of windows) assert.ok(labels.some((label) => Number(label) >= from && Number(label) <= to), `${labels} has none from ${from} to ${to}`);
    await close();
  });

  test('gives the labels of an ordinate the room that they need, minus sign included', async () => {
    const x = steps(0, 10, 50);
    const { page, close } = await open_sections(one(time_series(x, [[{ name: 'a', y: x.map((t) => -123456.5 - 0.002 * t) }], [{ name: 'b', y: x.map((t) => t) }]])));
    await page.waitForTimeout(200);
    const axes = await page.evaluate(() =>
      [...document.querySelectorAll('.plot')].map(({ uplot }) => {
        const context = document.createElement('canvas').getContext('2d');
        context.font = '12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif';
        const labels = uplot.axes[1]._values;
        return { labels, room: uplot.bbox.left / devicePixelRatio, wide: Math.max(...labels.map((text) => context.measureText(text).width)) };
      }),
    );
    assert.ok(axes[0].labels.every((label) => label.startsWith('−')), String(axes[0].labels));
    assert.ok(axes[0].room >= axes[0].wide + 11, `${axes[0].wide} px wide labels in ${axes[0].room} px`);
    assert.ok(axes[0].wide > 60, 'these labels are wider than any fixed axis would be');
    assert.equal(axes[1].room, axes[0].room, 'the panels of a figure stay in line');
    await close();
  });

  test('shows a dash where samples are missing, and no line across', async () => {
    // 1 Hz, with 17 s missing in one line as null and in the other as a pause of the recording.
    const all = steps(0, 100, 101);
    const with_null = all.map((t) => (t > 40 && t < 57 ? null : t));
    const paused = all.filter((t) => t <= 40 || t >= 57);
    const figure = time_series(all, [[{ name: 'null', y: with_null }, { name: 'paused', x: 1, y: paused.map((t) => 2 * t) }]]);
    figure.xs.push(paused);
    const { page, close } = await open_sections(one(figure));
    const values = () => page.locator('.legend .value').allInnerTexts();
    await hover(page, 0.52);
    assert.deepEqual(await values(), ['–', '–']);
    assert.match(await page.locator('.clock').innerText(), /^time 5[12]/);
    await hover(page, 0.3);
    const [a, b] = (await values()).map(Number);
    assert.ok(Math.abs(a - 30) < 1 && Math.abs(b - 60) < 2, `${a} ${b}`);
    const drawn = await page.evaluate(() => {
      const { data } = document.querySelector('.plot').uplot;
      return [1, 2].map((k) => data[0].some((t, i) => t > 41 && t < 56 && data[k][i] === null));
    });
    assert.deepEqual(drawn, [true, true]);
    await close();
  });

  test('keeps its scale where one method fails, says so, and shows the whole range on request', async () => {
    const x = steps(0, 10, 200);
    const lines = [
      { name: 'measured', role: 'measured', y: x.map((t) => Math.sin(t)) },
      { name: 'good', y: x.map((t) => 1.1 * Math.sin(t)) },
      { name: 'failed', y: x.map((t) => Math.exp(2 * t)) },
    ];
    const { page, close } = await open_sections(one(time_series(x, [lines])));
    const [low, high] = await scale(page, 'y');
    assert.ok(low > -3 && high < 3, `${low} ${high}`);
    assert.deepEqual(await page.locator('.legend li:has(.off-scale:not([hidden])) .name').allInnerTexts(), ['failed']);
    const button = page.locator('.full-range');
    await button.click();
    assert.ok((await scale(page, 'y'))[1] > 1e8);
    assert.equal(await page.locator('.off-scale:not([hidden])').count(), 0);
    await button.click();
    assert.ok((await scale(page, 'y'))[1] < 3);
    await close();
  });

  test('does not call off scale what is merely larger than the rest', async () => {
    const x = steps(0, 10, 200);
    const lines = [
      { name: 'measured', role: 'measured', y: x.map((t) => Math.sin(t)) },
      { name: 'model', y: x.map((t) => 3 * Math.sin(t)) },
    ];
    const { page, close } = await open_sections(one(time_series(x, [lines, [{ name: 'down', y: x.map((t) => 0.1 * t) }, { name: 'north', y: x.map((t) => 5 * t) }]])));
    assert.equal(await page.locator('.off-scale:not([hidden])').count(), 0);
    assert.equal(await page.locator('.full-range:not([hidden])').count(), 0);
    assert.ok((await scale(page, 'y', 1))[1] > 50);
    await close();
  });

  test('keeps the scale of estimates where one method fails', async () => {
    const estimate = (method, value, half) => ({ method, value, low: value - half, high: value + half, status: 'identified' });
    const { page, close } = await open_sections(
      one({
        kind: 'intervals',
        title: 'Estimates',
        caption: '',
        methods: ['OLS', 'TLS', 'GTLS', 'failed'],
        reference: 'truth',
        shared_scale: false,
        rows: [{ name: 'C', unit: '', reference: null, estimates: [estimate(0, 1, 0.1), estimate(1, 1.1, 0.1), estimate(2, 0.95, 0.1), estimate(3, 1e5, 0.1)] }],
      }),
    );
    const largest = async () => Math.max(...(await page.locator('.interval-picture .tick').allTextContents()).map((text) => Number(text.replace('−', '-'))));
    assert.ok((await largest()) < 3);
    assert.equal(await page.locator('.interval-picture .beyond').count(), 1);
    await page.locator('.full-range').click();
    assert.ok((await largest()) >= 1e5);
    await page.locator('.legend button', { hasText: 'failed' }).click();
    assert.equal(await page.locator('.interval-picture g.estimate').count(), 3);
    await close();
  });

  test('shows the labels of a row of estimates in full, and breaks long names at an underscore only', async () => {
    const row = (name, value) => ({ name, unit: 'm', reference: null, estimates: [{ method: 0, value, low: value - 0.0011, high: value + 0.0011, status: 'identified' }] });
    const { page, close } = await open_sections(
      one({ kind: 'intervals', title: 'Estimates', caption: '', methods: ['OLS'], reference: 'truth', shared_scale: false, rows: [row('understeer_gradient', -0.001), row('a', 0.0014), row('b', -123.4561)] }),
    );
    await page.waitForTimeout(150);
    const cut = await page.evaluate(() =>
      [...document.querySelectorAll('.interval-picture svg')].flatMap((picture) => {
        const frame = picture.getBoundingClientRect();
        return [...picture.querySelectorAll('.tick')].filter((tick) => tick.getBoundingClientRect().left < frame.left || tick.getBoundingClientRect().right > frame.right).map((tick) => tick.textContent);
      }),
    );
    assert.deepEqual(cut, []);
    const lines = await page.evaluate(() => {
      const texts = document.querySelector('.interval-name span').childNodes;
      return [...texts].filter((each) => each.nodeType === Node.TEXT_NODE).map((each) => { const range = document.createRange(); range.selectNode(each); return range.getClientRects().length; });
    });
    assert.deepEqual(lines, [1, 1]);
    await close();
  });

  test('writes true minus signs in the texts of a table too, and leaves other hyphens', async () => {
    const columns = ['change', 'day'].map((name) => ({ name, unit: '', align: 'right', group: '' }));
    const { page, close } = await open_sections(one({ kind: 'table', title: 'Changes', caption: '', columns, sortable: false, rows: [{ status: '', cells: [{ t: '-4 %' }, { t: '2022-07-21, g-g' }] }] }));
    assert.deepEqual(await page.locator('tbody td').allInnerTexts(), ['\u22124 %', '2022-07-21, g-g']);
    await close();
  });

  test('switches series off and on by its legend, with the keyboard too', async () => {
    const x = steps(0, 10, 50);
    const lines = [{ name: 'small', y: x.map((t) => t) }, { name: 'large', y: x.map((t) => 20 * t) }];
    const { page, close } = await open_sections(one(time_series(x, [lines, lines])));
    const large = page.locator('.legend button', { hasText: 'large' });
    assert.ok((await scale(page, 'y'))[1] > 190);
    await large.first().click();
    assert.deepEqual(await large.evaluateAll((all) => all.map((each) => each.getAttribute('aria-pressed'))), ['false', 'false']);
    await page.waitForTimeout(100);
    for (const plot of [0, 1]) assert.ok((await scale(page, 'y', plot))[1] < 12, 'the ordinate is that of what is left');
    await large.nth(1).focus();
    await page.keyboard.press('Space');
    await page.waitForTimeout(100);
    assert.ok((await scale(page, 'y'))[1] > 190);
    await close();
  });

  test('zooms upwards as well as along, and a double click brings everything back', async () => {
    const x = steps(0, 100, 500);
    const line = [{ name: 'a', y: x.map((t) => Math.sin(t / 5)) }];
    const { page, close } = await open_sections(one(time_series(x, [line, line])));
    const before = [await scale(page, 'x'), await scale(page, 'y')];
    await drag(page, [0.3, 0.2], [0.31, 0.7]);
    let y = await scale(page, 'y');
    assert.ok(y[1] - y[0] < 0.6 * (before[1][1] - before[1][0]), `${y}`);
    assert.deepEqual(await scale(page, 'x'), before[0], 'upwards only');
    assert.deepEqual(await scale(page, 'y', 1), before[1], 'this panel only');
    assert.equal(await page.locator('#reset-zoom').isVisible(), true);
    await page.locator('.u-over').first().dblclick();
    await page.waitForTimeout(100);
    assert.deepEqual([await scale(page, 'x'), await scale(page, 'y')], before);
    await drag(page, [0.2, 0.2], [0.6, 0.7]);
    y = await scale(page, 'y');
    assert.ok(y[1] - y[0] < 0.6 * (before[1][1] - before[1][0]), `${y}`);
    const both = await scale(page, 'x');
    assert.ok(Math.abs(both[0] - 20) < 2 && Math.abs(both[1] - 60) < 2, `${both}`);
    assert.deepEqual(await scale(page, 'x', 1), both);
    await page.locator('#reset-zoom').click();
    await page.waitForTimeout(100);
    assert.deepEqual([await scale(page, 'x'), await scale(page, 'y')], before);
    await close();
  });

  test('zooms a plot over a free abscissa and back', async () => {
    const x = steps(0, 100, 100);
    const series = { name: 'a', role: 'estimate', style: 'line', width: 0, opacity: 1, x, y: x.map((t) => t * t) };
    const { page, close } = await open_sections(
      one({ kind: 'xy', title: 'XY', caption: '', footnote: '', x: { label: 'x', unit: '' }, y: { label: 'y', unit: '' }, height: 260, equal_axes: false, equal_scale: false, series: [series], guides: [] }),
    );
    const before = [await scale(page, 'x'), await scale(page, 'y')];
    await drag(page, [0.2, 0.2], [0.5, 0.7]);
    const x_range = await scale(page, 'x');
    assert.ok(x_range[1] - x_range[0] < 0.4 * (before[0][1] - before[0][0]), `${x_range}`);
    await page.locator('.u-over').dblclick();
    await page.waitForTimeout(100);
    assert.deepEqual([await scale(page, 'x'), await scale(page, 'y')], before);
    await close();
  });

  test('draws decades and the area of a mask', async () => {
    const series = (name, style) => ({ name, role: 'estimate', style, width: 0, opacity: 1, x: [0.1, 1, 10, 0], y: [1, 0.8, 0.4, 5] });
    const plot = {
      kind: 'xy', title: 'Gain', caption: '', footnote: '', x: { label: 'frequency', unit: 'rad/s' }, y: { label: 'gain', unit: '' },
      height: 260, equal_axes: false, equal_scale: false, log_x: true, guides: [],
      series: [series('a', 'line'), series('a', 'markers')],
      areas: [{ name: 'mask', x: [0.2, 5], low: [0.2, 0.1], high: [null, null] }],
    };
    const { page, close } = await open_sections(one(plot));
    await page.waitForTimeout(200);
    const [low, high] = await scale(page, 'x');
    assert.ok(Math.abs(low + 1) < 0.2 && Math.abs(high - 1) < 0.2, `${low} ${high}`);
    const labels = await page.evaluate(() => document.querySelector('.plot').uplot.axes[0]._values);
    for (const label of ['0.1', '1', '10']) assert.ok(labels.includes(label), String(labels));
    assert.equal(await page.locator('.legend li').count(), 2, 'the line with its markers, and the mask');
    assert.equal(await page.locator('.legend .patch').count(), 1);
    // Above its lower edge the area goes as far as the plot; below, and left of it, there is none.
    const painted = await page.evaluate(() => {
      const { uplot } = document.querySelector('.plot');
      const { data, width } = uplot.ctx.getImageData(0, 0, uplot.ctx.canvas.width, uplot.ctx.canvas.height);
      const up = uplot.scales.y.max - 0.02;
      return [0.13, -0.87].map((at) => data[4 * (Math.round(uplot.valToPos(up, 'y', true)) * width + Math.round(uplot.valToPos(at, 'x', true))) + 3]);
    });
    assert.ok(painted[0] > 0, 'within');
    assert.equal(painted[1], 0, 'left of it');
    const [saved] = await Promise.all([page.waitForEvent('download'), page.getByLabel('Save Gain as SVG').click()]);
    const text = readFileSync(await saved.path(), 'utf8');
    assert.match(text, /<polygon/);
    assert.ok(!/NaN/.test(text));
    await close();
  });

  test('gives every line a look of its own, however many there are', async () => {
    const x = steps(0, 10, 11);
    const { page, close } = await open_sections(one(time_series(x, [Array.from({ length: 9 }, (_, k) => ({ name: `line ${k}`, y: x.map((t) => t + k) }))])));
    const looks = await page.evaluate(() => [...document.querySelectorAll('.legend .swatch')].map((each) => `${each.className} ${each.getAttribute('style')}`));
    assert.equal(looks.length, 9);
    assert.equal(new Set(looks).size, 9, String(looks));
    await close();
  });

  test('is saved as SVG and as PNG, as it stands', async () => {
    const x = steps(0, 10, 50);
    const lines = [{ name: 'kept', y: x }, { name: 'switched off', y: x.map((t) => 2 * t) }];
    const { page, close } = await open_sections(one(time_series(x, [lines], { title: 'Speed & path' })), { acceptDownloads: true });
    await page.locator('.legend button', { hasText: 'switched off' }).click();
    const save = async (kind) => {
      const [download] = await Promise.all([page.waitForEvent('download'), page.locator('figure button', { hasText: kind }).click()]);
      return { name: download.suggestedFilename(), bytes: readFileSync(await download.path()) };
    };
    const svg = await save('SVG');
    assert.equal(svg.name, 'sample-aircraft-flight-12-speed-path.svg');
    const text = svg.bytes.toString('utf8');
    assert.match(text, /^<svg xmlns="http:\/\/www.w3.org\/2000\/svg"/);
    assert.ok(text.includes('kept') && !text.includes('switched off'));
    assert.ok(text.includes('value [m]') && text.includes('time [s]'));
    assert.ok(!text.includes('NaN') && !text.includes('color-mix'));
    const png = await save('PNG');
    assert.deepEqual([...png.bytes.subarray(0, 4)], [0x89, 0x50, 0x4e, 0x47]);
    assert.ok(png.bytes.readUInt32BE(16) === 1920, `${png.bytes.readUInt32BE(16)} px wide`);
    await close();
  });

  test('draws windows of time side by side, each with its own time', async () => {
    const x = [...steps(20, 28, 81), ...steps(290, 298, 81)];
    const { page, close } = await open_sections(one(time_series(x, [[{ name: 'a', y: x.map((t) => (t < 100 ? 1 : 5)) }]], { windows: [{ from: 20, to: 28 }, { from: 290, to: 298 }] })));
    assert.equal(await page.locator('.windows .time-series').count(), 1);
    const labels = await page.evaluate(() => document.querySelector('.plot').uplot.axes[0]._values);
    assert.ok(labels.includes('22') && labels.includes('292') && !labels.includes('150'), String(labels));
    // Each window takes half of the width, although they are 262 s apart.
    await hover(page, 0.25);
    assert.match(await page.locator('.clock').innerText(), /^time 2[34]/);
    assert.equal(await page.locator('.legend .value').innerText(), '1.000');
    await hover(page, 0.75);
    assert.match(await page.locator('.clock').innerText(), /^time 29[34]/);
    assert.equal(await page.locator('.legend .value').innerText(), '5.000');
    await hover(page, 0.5);
    assert.equal(await page.locator('.legend .value').innerText(), '–');
    await close();
  });

  test('wraps many windows into rows', async () => {
    const windows = Array.from({ length: 13 }, (_, k) => ({ from: 10 * k, to: 10 * k + 5 }));
    const x = windows.flatMap(({ from, to }) => steps(from, to, 20));
    const { page, close } = await open_sections(one(time_series(x, [[{ name: 'a', y: x }]], { windows })));
    assert.equal(await page.locator('.windows .time-series').count(), 3);
    await close();
    const phone = await open_sections(one(time_series(x, [[{ name: 'a', y: x }]], { windows })), { viewport: { width: 400, height: 800 } });
    assert.equal(await phone.page.locator('.windows .time-series').count(), 7);
    await phone.close();
  });
});
