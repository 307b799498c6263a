// Exposure, tone map and sRGB curve in one look-up by half float bits; the formulas are those of src/image/tone_map.h.

const TONE_MAPS = {
  srgb: x => x,
  reinhard: x => x / (1 + x),
  aces: x => x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14),
  filmic: (() => {
    const curve = x => (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3;
    return x => curve(2 * x) / curve(11.2);
  })(),
};

const srgbFromLinear = x => x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;

function toneTable(name, exposure) {
  const table = new Uint8ClampedArray(65536), curve = TONE_MAPS[name], scale = 2 ** exposure;
  for (let bits = 0; bits < 65536; ++bits) {
    const value = HALF_VALUES[bits] * scale;
    table[bits] = value === Infinity ? 255 : 255 * srgbFromLinear(Math.min(1, Math.max(0, curve(Math.max(0, value)))));
  }
  return table;
}

// Fills `canvas` (of the picture's size) with the toned picture; pixels that are not finite turn magenta.
function drawToned(picture, canvas, table) {
  const context = canvas.getContext('2d'), target = context.createImageData(picture.width, picture.height);
  const pixels = target.data, [r, g, b] = picture.channels;
  for (let i = 0, o = 0; i < r.length; ++i, o += 4) {
    const finite = (r[i] & 0x7c00) !== 0x7c00 && (g[i] & 0x7c00) !== 0x7c00 && (b[i] & 0x7c00) !== 0x7c00;
    pixels[o] = finite ? table[r[i]] : 255;
    pixels[o + 1] = finite ? table[g[i]] : 0;
    pixels[o + 2] = finite ? table[b[i]] : 255;
    pixels[o + 3] = 255;
  }
  context.putImageData(target, 0, 0);
}
