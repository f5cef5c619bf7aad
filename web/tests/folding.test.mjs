// Sections that fold: what an engineer needs first is open, everything else one step away.
import assert from 'node:assert/strict';
import { describe, test } from 'node:test';
import { skip, steps, time_series, with_browser } from './page.mjs';

describe('a section', { skip }, () => {
  const tester = with_browser();
  const x = steps(0, 10, 50);
  const figure = time_series(x, [[{ name: 'a', y: x }]]);
  const sections = [
    { id: 'parameters', title: 'Parameters', blocks: [{ kind: 'paragraph', text: 'Numbers.', tone: 'plain' }] },
    { id: 'details', title: 'Details', folded: true, blocks: [figure, figure] },
    { id: 'more', title: 'More', folded: true, blocks: [figure] },
  ];
  const states = (page) => page.evaluate(() => [...document.querySelectorAll('details.section')].map((each) => each.open));

  test('is open or folded as the report says, and tells what it holds', async () => {
    const { page, close } = await tester.open_sections(sections);
    assert.deepEqual(await states(page), [true, false, false]);
    assert.deepEqual(await page.locator('details:not([open]) .inside').allInnerTexts(), ['2 figures', '1 figure']);
    await close();
  });

  test('keeps a long report short: what is folded takes a line', async () => {
    const long = [sections[0], ...Array.from({ length: 12 }, (_, k) => ({ id: `s${k}`, title: `Section ${k}`, folded: true, blocks: [figure, figure, figure] }))];
    const { page, close } = await tester.open_sections(long);
    const height = () => page.evaluate(() => document.documentElement.scrollHeight);
    assert.ok((await height()) < 2500, `36 figures in folded sections make a page of ${await height()} px`);
    await page.locator('#expand-all').click();
    await page.waitForTimeout(100);
    assert.ok((await height()) > 5000, 'unfolded they are all there');
    await close();
  });

  test('opens and folds by the keyboard, its state told to whoever cannot see it', async () => {
    const { page, close } = await tester.open_sections(sections);
    await page.locator('#details summary').focus();
    await page.keyboard.press('Enter');
    assert.deepEqual(await states(page), [true, true, false]);
    await page.waitForTimeout(150);
    const [host, plot] = await page.locator('#details .plot').first().evaluate((each) => [each.clientWidth, each.uplot.width]);
    assert.equal(plot, host, 'a figure that was folded takes the width of the page');
    const client = await page.context().newCDPSession(page);
    const { nodes } = await client.send('Accessibility.getFullAXTree');
    const expanded = nodes.filter((node) => node.role?.value === 'DisclosureTriangle').map((node) => node.properties.find((each) => each.name === 'expanded')?.value.value);
    assert.deepEqual(expanded, [true, true, false]);
    await page.keyboard.press('Space');
    assert.deepEqual(await states(page), [true, false, false]);
    await close();
  });

  test('opens with all others at one click, and folds again', async () => {
    const { page, close } = await tester.open_sections(sections);
    const button = page.locator('#expand-all');
    await button.click();
    assert.deepEqual(await states(page), [true, true, true]);
    await page.waitForTimeout(50);
    assert.equal(await button.innerText(), 'Fold all');
    await button.click();
    assert.deepEqual(await states(page), [false, false, false]);
    await close();
  });

  test('opens when a link leads to it', async () => {
    const { page, close } = await tester.open_sections(sections);
    const link = page.locator('.contents a', { hasText: 'More' });
    await link.click();
    await page.waitForTimeout(100);
    assert.deepEqual(await states(page), [true, false, true]);
    await page.locator('#more summary').click();
    await link.click();
    await page.waitForTimeout(100);
    assert.deepEqual(await states(page), [true, false, true], 'the same link once more');
    await close();
    const other = await tester.open_sections(sections, {}, '#details');
    assert.deepEqual(await states(other.page), [true, true, false]);
    await other.close();
  });

  test('is open on paper, and as before afterwards', async () => {
    const { page, close } = await tester.open_sections(sections);
    await page.evaluate(() => addEventListener('beforeprint', () => (window.seen = [...document.querySelectorAll('details')].map((each) => each.open))));
    await page.pdf({ format: 'A4' });
    assert.deepEqual(await page.evaluate(() => window.seen), [true, true, true]);
    assert.deepEqual(await states(page), [true, false, false]);
    await close();
  });
});
