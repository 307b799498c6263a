// False-colour views of the error against the reference.

// Control points in sRGB bytes, equally spaced. `heat` grows in brightness all the way; `balance` is grey at zero, blue where the picture
// is too dark and orange where it is too bright.
const COLOR_STOPS = {
  heat: [[8, 8, 12], [38, 22, 82], [98, 28, 116], [168, 44, 96], [222, 86, 52], [246, 158, 38], [252, 224, 110], [255, 255, 236]],
  balance: [[120, 205, 255], [40, 120, 220], [24, 56, 110], [40, 40, 40], [112, 52, 16], [224, 116, 24], [255, 212, 128]],
};

// 1024 entries of r, g, b.
function colorTable(name) {
  const stops = COLOR_STOPS[name], table = new Uint8ClampedArray(3 * 1024);
  for (let i = 0; i < 1024; ++i) {
    const position = i / 1023 * (stops.length - 1), k = Math.min(stops.length - 2, Math.floor(position)), f = position - k;
    for (let c = 0; c < 3; ++c) table[3 * i + c] = stops[k][c] * (1 - f) + stops[k + 1][c] * f;
  }
  return table;
}

// Each kind maps a pixel's two colours to one number; `signed` ones use the balance colours around zero.
const luminanceAt = (channels, i) =>
  0.2126 * HALF_VALUES[channels[0][i]] + 0.7152 * HALF_VALUES[channels[1][i]] + 0.0722 * HALF_VALUES[channels[2][i]];
const largestDifference = (a, b, i) => Math.max(
  Math.abs(HALF_VALUES[a[0][i]] - HALF_VALUES[b[0][i]]),
  Math.abs(HALF_VALUES[a[1][i]] - HALF_VALUES[b[1][i]]),
  Math.abs(HALF_VALUES[a[2][i]] - HALF_VALUES[b[2][i]]));
const ERROR_KINDS = {
  absolute: { label: 'absolute  |I − R|', at: largestDifference },
  relative: { label: 'relative  |I − R| / (R + 0.01)', at: (a, b, i) => largestDifference(a, b, i) / (luminanceAt(b, i) + 0.01) },
  signed: { label: 'signed  (I − R) / (R + 0.01)', signed: true, at: (a, b, i) => {
    const reference = luminanceAt(b, i);
    return (luminanceAt(a, i) - reference) / (reference + 0.01);
  } },
};

// Error of every pixel as a Float32Array; computed once for each picture and kind.
function errorMap(picture, reference, kind) {
  const values = new Float32Array(picture.width * picture.height), at = ERROR_KINDS[kind].at;
  for (let i = 0; i < values.length; ++i) values[i] = at(picture.channels, reference.channels, i);
  return values;
}

function drawError(values, kind, range, canvas) {
  const signed = !!ERROR_KINDS[kind].signed, table = colorTable(signed ? 'balance' : 'heat');
  const context = canvas.getContext('2d'), target = context.createImageData(canvas.width, canvas.height), pixels = target.data;
  for (let i = 0, o = 0; i < values.length; ++i, o += 4) {
    const position = signed ? 0.5 + 0.5 * values[i] / range : values[i] / range;
    const entry = 3 * Math.round(1023 * Math.min(1, Math.max(0, position)));
    const finite = Number.isFinite(values[i]);
    pixels[o] = finite ? table[entry] : 255;
    pixels[o + 1] = finite ? table[entry + 1] : 0;
    pixels[o + 2] = finite ? table[entry + 2] : 255;
    pixels[o + 3] = 255;
  }
  context.putImageData(target, 0, 0);
}

// The value that 99 % of the pixels stay below: a range in which something can be seen.
function usualError(values) {
  const sample = [];
  const step = Math.max(1, Math.floor(values.length / 20000));
  for (let i = 0; i < values.length; i += step) if (Number.isFinite(values[i])) sample.push(Math.abs(values[i]));
  sample.sort((a, b) => a - b);
  return sample.length ? sample[Math.floor(0.99 * (sample.length - 1))] : 0;
}
