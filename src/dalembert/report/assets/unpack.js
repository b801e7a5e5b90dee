// Columns of numbers out of the packed text of a page: differences of an order, by planes of bytes, deflated.

const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

// The browser's own way; where it has none, or takes no deflate, ours.
async function inflated(bytes) {
  if (typeof DecompressionStream === "undefined") return inflate(bytes);
  try {
    return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
  } catch {
    return inflate(bytes);
  }
}

// Deflate after RFC 1951, in the envelope of RFC 1950.
function inflate(bytes) {
  let at = 2, bit = 0, size = 0, out = new Uint8Array(8 * bytes.length);
  const take = (count) => {
    let value = 0;
    for (let k = 0; k < count; k++) { value |= ((bytes[at] >> bit) & 1) << k; if (++bit === 8) { bit = 0; at++; } }
    return value;
  };
  const put = (byte) => {
    if (size === out.length) { const wider = new Uint8Array(2 * out.length); wider.set(out); out = wider; }
    out[size++] = byte;
  };
  // Codes by their lengths: how many there are of each, and the symbols in their order.
  const tree = (lengths) => {
    const counts = new Uint16Array(16), places = new Uint16Array(16), symbols = [];
    for (const length of lengths) counts[length]++;
    counts[0] = 0;
    for (let k = 1; k < 16; k++) places[k] = places[k - 1] + counts[k - 1];
    lengths.forEach((length, symbol) => { if (length) symbols[places[length]++] = symbol; });
    return { counts, symbols };
  };
  const symbol = ({ counts, symbols }) => {
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
  const base = (extra, first) => extra.map((_, k) => first + extra.slice(0, k).reduce((sum, e) => sum + 2 ** e, 0));
  const moreLength = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5], lengthBase = [...base(moreLength, 3), 258];
  const moreWay = Array.from({ length: 30 }, (_, k) => Math.max(0, (k >> 1) - 1)), wayBase = base(moreWay, 1);
  const order = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
  const dynamic = () => {
    const [literals, ways, count] = [take(5) + 257, take(5) + 1, take(4) + 4], codes = Array(19).fill(0), lengths = [];
    for (let k = 0; k < count; k++) codes[order[k]] = take(3);
    const coded = tree(codes);
    while (lengths.length < literals + ways) {
      const s = symbol(coded);
      if (s < 16) lengths.push(s);
      else lengths.push(...Array(s === 16 ? take(2) + 3 : s === 17 ? take(3) + 3 : take(7) + 11).fill(s === 16 ? lengths.at(-1) : 0));
    }
    return [tree(lengths.slice(0, literals)), tree(lengths.slice(literals))];
  };
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
    const fixed = () => [tree([...Array(144).fill(8), ...Array(112).fill(9), ...Array(24).fill(7), ...Array(8).fill(8)]), tree(Array(30).fill(5))];
    const [literal, way] = kind === 1 ? fixed() : dynamic();
    for (let s = symbol(literal); s !== 256; s = symbol(literal)) {
      if (s < 256) { put(s); continue; }
      const length = lengthBase[s - 257] + take(moreLength[s - 257] ?? 0), w = symbol(way), back = wayBase[w] + take(moreWay[w]);
      for (let k = 0; k < length; k++) put(out[size - back]);
    }
  }
  return out.subarray(0, size);
}

function readColumn({ n, low, step, planes, gaps, order }, data, at) {
  const sums = Array(order).fill(0);
  const values = new Float64Array(n).fill(+low);
  for (let i = 0; planes && i < n; i++) {
    let code = 0;
    for (let k = planes - 1; k >= 0; k--) code = 256 * code + data[at + k * n + i];
    let sum = code % 2 ? -(code + 1) / 2 : code / 2;
    for (let k = 0; k < order; k++) sum = sums[k] += sum;
    values[i] = +low + sum * step;
  }
  for (const [first, count] of gaps || []) values.fill(NaN, first, first + count);
  return +step === 1 ? Array.from(values) : values;  // whole numbers are places in other lists
}

// The payload with its columns in their places.
async function unpacked(payload) {
  if (!payload.columns) return payload;
  const data = await inflated(bytesOf(payload.columns.data)), columns = [];
  let at = 0;
  for (const head of payload.columns.heads) { columns.push(readColumn(head, data, at)); at += head.n * head.planes; }
  const put = (value) => {
    if (Array.isArray(value)) return value.map(put);
    if (!value || typeof value !== "object") return value;
    const keys = Object.keys(value);
    if (keys.length === 1 && keys[0] === "column") return columns[value.column];
    return Object.fromEntries(keys.map((key) => [key, put(value[key])]));
  };
  return put({ ...payload, columns: undefined });
}

// What the page shows.
const payload = await unpacked(JSON.parse(document.getElementById("data").textContent));
