// From the bytes that a page carries to its scene and its voxels, or one sentence that says what is damaged.

const FORMAT = 2;
const AGAIN = "write or send the page again";

/**
 * Unpack gzipped bytes; their checksum tells where any is damaged.
 * @param {Uint8Array} bytes
 * @param {string} [name] what they are, for the sentence
 * @returns {Promise<Uint8Array>}
 */
export async function gunzip(bytes, name = "data") {
  if (typeof DecompressionStream === "undefined") {
    throw new Error("this browser cannot unpack gzip: open the page in a newer one");
  }
  try {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new Error(`the page's ${name} came damaged or cut off (its gzip does not unpack): ${AGAIN}`);
  }
}

/**
 * Bytes of a base64 text.
 * @param {string} text
 * @returns {Uint8Array}
 */
export function fromBase64(text) {
  try {
    if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
    return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  } catch {
    throw new Error(`the page's data is not base64, some of its letters are damaged: ${AGAIN}`);
  }
}

/**
 * The scene: what stands where, under which light, and what is wanted.
 * @param {Uint8Array} bytes gzipped JSON
 * @returns {Promise<object>}
 */
export async function readScene(bytes) {
  const unpacked = await gunzip(bytes, "scene");
  let scene;
  try {
    scene = JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(unpacked));
  } catch {
    throw new Error(`the page's scene is not readable JSON: ${AGAIN}`);
  }
  const format = scene?.format;
  if (format === FORMAT) return scene;
  if (format > FORMAT) {
    throw new Error(`the page's data has format ${format}, newer than ${FORMAT}: update the viewer that opens it`);
  }
  throw new Error(`the page's data has format ${format}, not ${FORMAT}: write the page again with this version`);
}

/**
 * The codes of the voxels, and what they stand for.
 *
 * The bytes are first the high 8 bits of every code, [channel][z][y][x], then their low 2, 4 or 8 bits, as many to a
 * byte as it holds, the first one lowest.
 * @param {Uint8Array} bytes gzipped
 * @param {object} scene
 * @returns {Promise<{shape: number[], voxel_mm: number, bits: number, codes: Uint16Array, tables: Float32Array[]}>} three
 *   codes of so many bits for each voxel, [z][y][x][channel], and each channel's extinction (1/mm) by code
 */
export async function readVoxels(bytes, scene) {
  const { shape, voxel_mm, channels, bits, least, rates } = scene.voxels;
  const unpacked = await gunzip(bytes, "voxels");
  const count = shape[0] * shape[1] * shape[2];
  const low = bits - 8;
  const size = count * channels + Math.ceil((count * channels * low) / 8);
  if (unpacked.length !== size) {
    const sizes = `${unpacked.length} bytes, not the ${size} of ${shape.join(" x ")} voxels in ${channels} channels`;
    throw new Error(`the page's voxels have ${sizes}: ${AGAIN}`);
  }
  const codes = new Uint16Array(3 * count);
  for (let channel = 0; channel < 3; channel++) {
    const first = (channels === 1 ? 0 : channel) * count;
    for (let voxel = 0; voxel < count; voxel++) {
      const place = first + voxel;
      const ahead = place * low; // bits
      const rest = (unpacked[count * channels + (ahead >>> 3)] >> (ahead & 7)) & ((1 << low) - 1);
      codes[3 * voxel + channel] = (unpacked[place] << low) | rest;
    }
  }
  const tables = [0, 1, 2].map((channel) => tableOf(bits, least, rates[channels === 1 ? 0 : channel]));
  return { shape, voxel_mm, bits, codes, tables };
}

/** Extinction (1/mm) by code: nearly even steps up to about `least`, beyond it they grow with the extinction. */
function tableOf(bits, least, rate) {
  return Float32Array.from({ length: 2 ** bits }, (_, code) => least * Math.expm1(rate * code));
}
