// Deflated data in base64.

/** @param {string} text in base64 */
export const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

/** Inflate by the browser; by `inflate` in browsers without deflate. @param {Uint8Array<ArrayBuffer>} bytes */
export async function inflated(bytes) {
  if (typeof DecompressionStream === "undefined") return inflate(bytes);
  try {
    return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
  } catch {
    return inflate(bytes);
  }
}

/** Deflate after RFC 1951, in the format of RFC 1950. @param {Uint8Array} bytes */
function inflate(bytes) {
  let at = 2, bit = 0, size = 0, out = new Uint8Array(8 * bytes.length);
  const take = (/** @type {number} */ count) => {
    let value = 0;
    for (let k = 0; k < count; k++) { value |= ((bytes[at] >> bit) & 1) << k; if (++bit === 8) { bit = 0; at++; } }
    return value;
  };
  const put = (/** @type {number} */ byte) => {
    if (size === out.length) { const wider = new Uint8Array(2 * out.length); wider.set(out); out = wider; }
    out[size++] = byte;
  };
  // Huffman codes by their lengths: the count of each length, and the symbols in their order.
  const tree = (/** @type {number[]} */ lengths) => {
    const counts = new Uint16Array(16), places = new Uint16Array(16);
    /** @type {number[]} */
    const symbols = [];
    for (const length of lengths) counts[length]++;
    counts[0] = 0;
    for (let k = 1; k < 16; k++) places[k] = places[k - 1] + counts[k - 1];
    lengths.forEach((length, symbol) => { if (length) symbols[places[length]++] = symbol; });
    return { counts, symbols };
  };
  const symbol = (/** @type {ReturnType<typeof tree>} */ { counts, symbols }) => {
    for (let length = 1, code = 0, first = 0, index = 0; length < 16; length++) {
      code |= take(1);
      const count = counts[length];
      if (code - count < first) return symbols[index + code - first];
      index += count;
      first = (first + count) << 1;
      code <<= 1;
    }
    throw new Error("the data of this page are damaged");
  };
  const base = (/** @type {number[]} */ extra, /** @type {number} */ first) => extra.map((_, k) => first + extra.slice(0, k).reduce((sum, e) => sum + 2 ** e, 0));
  const extraOfLength = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5], lengthBase = [...base(extraOfLength, 3), 258];
  const extraOfDistance = Array.from({ length: 30 }, (_, k) => Math.max(0, (k >> 1) - 1)), distanceBase = base(extraOfDistance, 1);
  const order = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
  const dynamicCodes = () => {
    const [literals, distances, count] = [take(5) + 257, take(5) + 1, take(4) + 4];
    const codes = Array(19).fill(0), lengths = /** @type {number[]} */ ([]);
    for (let k = 0; k < count; k++) codes[order[k]] = take(3);
    const coded = tree(codes);
    while (lengths.length < literals + distances) {
      const s = symbol(coded);
      if (s < 16) lengths.push(s);
      else lengths.push(...Array(s === 16 ? take(2) + 3 : s === 17 ? take(3) + 3 : take(7) + 11).fill(s === 16 ? lengths.at(-1) : 0));
    }
    return [tree(lengths.slice(0, literals)), tree(lengths.slice(literals))];
  };
  const fixedCodes = () => [tree([...Array(144).fill(8), ...Array(112).fill(9), ...Array(24).fill(7), ...Array(8).fill(8)]), tree(Array(30).fill(5))];
  for (let last = 0; !last;) {
    last = take(1);
    const kind = take(2);
    if (kind === 0) {
      if (bit) { bit = 0; at++; }
      const count = bytes[at] | (bytes[at + 1] << 8);
      at += 4;
      for (let k = 0; k < count; k++) put(bytes[at++]);
      continue;
    }
    const [literals, distances] = kind === 1 ? fixedCodes() : dynamicCodes();
    for (let s = symbol(literals); s !== 256; s = symbol(literals)) {
      if (s < 256) { put(s); continue; }
      const length = lengthBase[s - 257] + take(extraOfLength[s - 257] ?? 0), d = symbol(distances), back = distanceBase[d] + take(extraOfDistance[d]);
      for (let k = 0; k < length; k++) put(out[size - back]);
    }
  }
  return out.subarray(0, size);
}
