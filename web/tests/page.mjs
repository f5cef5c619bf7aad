// The sample report, or another document in its page, in headless Chromium, opened from its file as a user would.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { after, before } from 'node:test';
import { pathToFileURL } from 'node:url';
import { no_browser, start_browser } from './chromium.mjs';

export const sample = resolve(process.env.VERIDYN_SAMPLE_REPORT ?? 'sample_report.html');
// A missing browser is a reason to skip, a missing report is a failure.
export const skip = no_browser;
if (no_browser) console.log(no_browser);
else if (!existsSync(sample)) console.log(`no sample report at ${sample}: run veridyn_sample_report and set VERIDYN_SAMPLE_REPORT`);

/** A browser for the tests of a suite. */
export function with_browser() {
  const state = { browser: null, folder: null };

  before(async () => {
    state.folder = mkdtempSync(join(tmpdir(), 'veridyn-page-'));
    state.browser = await start_browser();
  });

  after(async () => {
    await state.browser?.close();
    if (state.folder) rmSync(state.folder, { recursive: true });
  });

  // Every page of every test is watched: nothing on the console, no request but for the file itself.
  state.open = async (options = {}, file = sample, hash = '') => {
    const context = await state.browser.newContext({ viewport: { width: 1280, height: 900 }, colorScheme: 'light', ...options });
    const page = await context.newPage();
    const complaints = [];
    page.on('console', (message) => complaints.push(`${message.type()}: ${message.text()}`));
    page.on('pageerror', (error) => complaints.push(`error: ${error.message}`));
    page.on('request', (request) => {
      const url = request.url();
      if (!url.startsWith('data:') && !url.startsWith('blob:') && url.replace(/#.*/, '') !== pathToFileURL(file).href) complaints.push(`request: ${url}`);
    });
    await page.goto(pathToFileURL(file).href + hash);
    await page.waitForSelector('#report.live');
    await page.waitForFunction(() => [...document.querySelectorAll('.plot')].every((host) => host.querySelector('canvas')));
    return {
      page,
      close: async () => {
        assert.deepEqual(complaints, []);
        await context.close();
      },
    };
  };

  let count = 0;

  /** Opens a page with these sections; each `{ title, blocks }`, with the rest as the program writes it. */
  state.open_sections = (sections, options = {}, hash = '', lead = []) => {
    const document = {
      format: 'veridyn-report',
      version: 1,
      generator: 'test',
      title: 'Test',
      subtitle: '',
      verdict: { level: 'good', word: 'Usable', headline: 'It works.', lines: [] },
      lead,
      facts: [],
      sections: sections.map((section, k) => ({ id: `section-${k}`, folded: false, inside: '', title: `Section ${k}`, ...section })),
    };
    const begin = '<script type="application/json" id="veridyn-document">';
    const page = readFileSync(sample, 'utf8');
    const from = page.indexOf(begin) + begin.length;
    const file = join(state.folder, `${++count}.html`);
    writeFileSync(file, page.slice(0, from) + JSON.stringify(document).replace(/</g, '\\u003c') + page.slice(page.indexOf('</script>', from)));
    return state.open(options, file, hash);
  };

  return state;
}

/** A time series of lines `{ name, y, role }` over `x`, one panel each entry of `panels`. */
export function time_series(x, panels, rest = {}) {
  return {
    kind: 'time_series',
    title: 'Figure',
    caption: '',
    footnote: '',
    axis: 'time',
    x: { label: 'time', unit: 's' },
    xs: [x],
    panels: panels.map((lines) => ({
      label: 'value',
      unit: 'm',
      height: 150,
      lines: lines.map((line) => ({ role: 'estimate', style: 'line', x: 0, ...line })),
    })),
    spans: [],
    ...rest,
  };
}

/** Numbers from `low` to `high`. */
export function steps(low, high, count) {
  return Array.from({ length: count }, (_, k) => low + ((high - low) * k) / (count - 1));
}
