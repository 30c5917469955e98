// Packed columns back to numbers: base64, gzip, byte shuffle, zigzag, second difference, quantum.

/** The values of a packed column. */
export async function unpack({ exponent, gaps, bytes }) {
  const shuffled = await gunzip(decode(bytes));
  const count = shuffled.length / 4;
  const values = new Float64Array(count);
  const power = 10 ** Math.abs(exponent);
  let whole = 0;
  let slope = 0;
  for (let k = 0; k < count; k++) {
    const word =
      shuffled[k] | (shuffled[count + k] << 8) | (shuffled[2 * count + k] << 16) | (shuffled[3 * count + k] << 24);
    slope += (word >>> 1) ^ -(word & 1);
    whole += slope;
    values[k] = exponent < 0 ? whole / power : whole * power;
  }
  for (const [first, length] of gaps) values.fill(NaN, first, first + length);
  return values;
}

function decode(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  return bytes;
}

async function gunzip(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
