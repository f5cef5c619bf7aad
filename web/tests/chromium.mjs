// Headless Chromium for the tests of pages; it asks nothing of a network.
import { existsSync } from 'node:fs';
import { chromium } from 'playwright-core';

const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
/** Why no page can be opened here, or false. */
export const no_browser = existsSync(executablePath) ? false : `no Chromium at ${executablePath}`;

export const start_browser = () =>
  chromium.launch({
    executablePath,
    args: [
      '--no-sandbox',
      '--disable-gpu',
      '--disable-quic',
      '--no-first-run',
      '--disable-background-networking',
      '--disable-component-update',
      '--disable-sync',
    ],
  });
