// Vectors of three numbers and rotations, on plain arrays.

/** Sum of products of two vectors. */
export function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** The vector that is upright on both, right-handed. */
export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** a + b. */
export function add(a, b) {
  return [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
}

/** a - b. */
export function sub(a, b) {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

/** A vector times a number. */
export function scaled(a, factor) {
  return [a[0] * factor, a[1] * factor, a[2] * factor];
}

/** Length of a vector. */
export function norm(a) {
  return Math.sqrt(dot(a, a));
}

/** The vector of length 1 that points the same way. */
export function unit(a) {
  const length = norm(a);
  return [a[0] / length, a[1] / length, a[2] / length];
}

/** Rest of a division in [0, by), of negative numbers too. */
export function modulo(value, by) {
  const rest = value % by;
  return rest < 0 ? rest + by : rest;
}

/**
 * Rotation counter-clockwise about an axis (O. Rodrigues, 1840), exact at multiples of 90 degrees.
 * @param {number[]} axis of any length
 * @param {number} degrees
 * @returns {number[]} 9 numbers, row by row
 */
export function rotation(axis, degrees) {
  const turn = modulo(degrees, 360);
  const quarter = Math.round(turn / 90);
  const rest = ((turn - 90 * quarter) * Math.PI) / 180;
  const [c, s] = [Math.cos(rest), Math.sin(rest)];
  const [cos, sin] = [[c, s], [-s, c], [-c, -s], [s, -c]][quarter % 4];
  const [x, y, z] = unit(axis);
  const about = [0, -z, y, z, 0, -x, -y, x, 0];
  return [x, y, z].flatMap((a, row) =>
    [x, y, z].map((b, column) => {
      const along = a * b;
      return cos * ((row === column ? 1 : 0) - along) + sin * about[3 * row + column] + along;
    }),
  );
}

/** Matrix (9 numbers, row by row) times vector. */
export function apply(m, v) {
  return [dot(m, v), m[3] * v[0] + m[4] * v[1] + m[5] * v[2], m[6] * v[0] + m[7] * v[1] + m[8] * v[2]];
}

/** The transpose of a matrix times a vector: the inverse of a rotation. */
export function applyInverse(m, v) {
  return [
    m[0] * v[0] + m[3] * v[1] + m[6] * v[2],
    m[1] * v[0] + m[4] * v[1] + m[7] * v[2],
    m[2] * v[0] + m[5] * v[1] + m[8] * v[2],
  ];
}
