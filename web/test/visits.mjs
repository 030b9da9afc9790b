// Visits to the page: fresh pages of a browser that count what they track, and everything that must
// not happen on them.

/** Time for whatever a page does [ms]. */
const PATIENCE_MS = 60_000;

/**
 * Visits with a browser, whose pages may load what comes from `url` and nothing else.
 * `faults` has what must not happen and did.
 */
export function visits(browser, url) {
  const faults = [];

  /** A fresh page at an address, after a script of the caller's. */
  async function open(address, options = {}, script = () => {}) {
    const context = await browser.newContext({ acceptDownloads: true, ...options });
    const page = await context.newPage();
    page.setDefaultTimeout(PATIENCE_MS);
    page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type())) faults.push(message.text());
    });
    page.on('pageerror', (error) => faults.push(String(error)));
    page.on('requestfailed', (request) => faults.push(`${request.url()} failed`));
    page.on('request', (request) => {
      const asked = request.url();
      const isOwn = [url, 'data:', 'blob:', 'file:'].some((start) => asked.startsWith(start));
      if (!isOwn) faults.push(`${asked} is elsewhere`);
    });
    await page.addInitScript(() => {
      globalThis.seen = { tracked: 0, firstMs: 0, last: undefined };
      document.addEventListener('posewise:tracked', ({ detail }) => {
        seen.last = detail;
        if (detail.result.state === 'tracking' && seen.tracked++ === 0) {
          seen.firstMs = performance.now();
        }
      });
    });
    await page.addInitScript(script);
    await page.goto(address);
    return page;
  }

  return { open, faults };
}

/** Waits until so many more frames were tracked. */
export async function untilTracked(page, count) {
  const before = await page.evaluate(() => seen.tracked);
  await page.waitForFunction((n) => seen.tracked >= n, before + count);
}
