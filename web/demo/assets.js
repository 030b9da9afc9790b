// Files of the page: from the server, or from within standalone.html, which holds them compressed.

/**
 * @param {string} name Its path from the folder that index.html is in.
 * @returns {Promise<ArrayBuffer>}
 */
export async function asset(name) {
  const block = document.getElementById(`asset:${name}`);
  if (!block) {
    const response = await fetch(new URL(name, document.baseURI));
    if (!response.ok) throw new Error(`${name}: ${response.status} ${response.statusText}`);
    return response.arrayBuffer();
  }
  const packed = Uint8Array.from(atob(block.textContent ?? ''), (char) => char.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Response(stream).arrayBuffer();
}

/**
 * @param {string} name A WebAssembly module, as for `asset`.
 * @returns {Promise<WebAssembly.Module>}
 */
export async function compiled(name) {
  if (isStandalone()) return WebAssembly.compile(await asset(name));
  const response = await fetch(new URL(name, document.baseURI));
  // A server that does not know the type would make the streaming compiler fail.
  const isKnown = response.headers.get('content-type') === 'application/wasm';
  if (isKnown) return WebAssembly.compileStreaming(response);
  if (!response.ok) throw new Error(`${name}: ${response.status} ${response.statusText}`);
  return WebAssembly.compile(await response.arrayBuffer());
}

/** Whether the page is standalone.html. */
export function isStandalone() {
  return document.getElementById('asset:worker.js') !== null;
}

/** A worker that runs worker.js, of standalone.html. */
export async function embeddedWorker() {
  const code = new Blob([await asset('worker.js')], { type: 'text/javascript' });
  // Not a module: pages on a disk may not start workers that are.
  return new Worker(URL.createObjectURL(code));
}
