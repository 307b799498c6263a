// Packed pictures (src/report/packed_image.h) to arrays of half float bits, one a channel.

// Value of every half float by its bits.
const HALF_VALUES = (() => {
  const values = new Float32Array(65536);
  for (let bits = 0; bits < 65536; ++bits) {
    const sign = bits & 0x8000 ? -1 : 1, exponent = bits >> 10 & 31, fraction = bits & 1023;
    values[bits] = exponent === 31 ? (fraction ? NaN : sign * Infinity)
      : exponent === 0 ? sign * fraction * 2 ** -24
      : sign * (1 + fraction / 1024) * 2 ** (exponent - 15);
  }
  return values;
})();

async function inflate(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// {width, height, channels: [r, g, b] of Uint16Array}
async function decodePicture(base64, width, height) {
  const planes = await inflate(base64), count = width * height;
  if (planes.length !== 6 * count) throw new Error(`a picture has ${planes.length} bytes instead of ${6 * count}`);
  const channels = [0, 1, 2].map(channel => {
    const values = new Uint16Array(count), high = 2 * channel * count, low = high + count;
    for (let i = 0; i < count; ++i) {
      const predicted = i === 0 ? 0 : i % width ? values[i - 1] : values[i - width];
      values[i] = predicted + (planes[high + i] << 8 | planes[low + i]);
    }
    return values;
  });
  return { width, height, channels };
}

function meanLuminance(picture) {
  const [r, g, b] = picture.channels;
  let sum = 0, finite = 0;
  for (let i = 0; i < r.length; ++i) {
    const y = 0.2126 * HALF_VALUES[r[i]] + 0.7152 * HALF_VALUES[g[i]] + 0.0722 * HALF_VALUES[b[i]];
    if (Number.isFinite(y)) { sum += y; ++finite; }
  }
  return finite ? sum / finite : 0;
}
