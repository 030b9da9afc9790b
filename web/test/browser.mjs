// The browser of the tests: Debian's Chromium, or the one that CHROMIUM names.

import { chromium } from 'playwright-core';

/** Starts it without a window. */
export function launch(...args) {
  const name = process.env.CHROMIUM ?? 'chromium';
  const executablePath = name.includes('/') ? name : `/usr/bin/${name}`;
  return chromium.launch({ executablePath, args: ['--no-sandbox', ...args] });
}
