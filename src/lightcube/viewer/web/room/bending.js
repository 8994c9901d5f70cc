// How glass bends light, for the program that casts: `model/glass.js` in GLSL, in voxel sides.

/**
 * `bend`: the light that reaches a pixel past the glass and through it. Its beam's start, whole + off as the walk has it, way
 * and length become those of the piece inside. Angles are handled by their sines and cosines: asin is coarse on many cards.
 * @param {object | null} glass of the scene
 */
export function bendingOf(glass) {
  const laws = { block: BLOCK, bath: BATH, cylinder: ROUND + CYLINDER, "round-bath": ROUND + CYLINDER, sphere: ROUND + SPHERE };
  return glass ? FRESNEL + laws[glass.form] : "";
}

const FRESNEL = `
uniform vec3 body;     // half its sides
uniform bool blocked;  // whether its bottom lets no light out

/* The part of light that passes two faces, aslant by the angle of this cosine outside. */
float letThrough(float cosine, float ior) {
  float inside = sqrt(1.0 - (1.0 - cosine * cosine) / (ior * ior));
  float across = (cosine - ior * inside) / (cosine + ior * inside);
  float along = (inside - ior * cosine) / (inside + ior * cosine);
  return (pow(1.0 - across * across, 2.0) + pow(1.0 - along * along, 2.0)) / 2.0;
}
`;

const BLOCK = `
vec2 bend(float ior, vec3 whole, vec3 normal, float travelled, inout vec3 off, inout vec3 way, out float to) {
  to = 0.0;
  vec3 place = (whole - 0.5 * vec3(textureSize(voxels, 0))) + off;
  bvec3 still = lessThan(abs(way), vec3(STILL));
  vec3 per = 1.0 / mix(way, vec3(1.0), still);
  vec3 one = (-body - place) * per, two = (body - place) * per;
  float first = most3(mix(min(one, two), vec3(-NEVER), still)), last = least3(mix(max(one, two), vec3(NEVER), still));
  if (!(first < last) || any(bvec3(vec3(still) * step(body, abs(place))))) return vec2(1.0, 0.0);
  for (int face = 0; face < 3; face++) {
    if (still[face] || (face == 2 && blocked)) continue;
    float straight = sqrt(ior * ior - (1.0 - way[face] * way[face]));
    float out_ = max(one[face], two[face]);
    vec3 back = way * (2.0 * body[face] / straight);
    back[face] = sign(way[face]) * 2.0 * body[face];
    vec3 leaves = place + way * out_, enters = leaves - back;
    vec3 least = max(abs(leaves), abs(enters));
    least[face] = 0.0;
    if (!all(lessThan(least, body))) continue;
    float cosine = abs(way[face]);
    off += way * out_ - back;
    to = length(back);
    way = back / to;
    return vec2(0.0, letThrough(cosine, ior));
  }
  return vec2(0.0);
}
`;

const BATH = `
vec2 bend(float ior, vec3 whole, vec3 normal, float travelled, inout vec3 off, inout vec3 way, out float to) {
  float level = length(way.xy);
  vec3 ahead = vec3(way.xy / level, 0.0);
  vec3 place = (whole - 0.5 * vec3(textureSize(voxels, 0))) + off;
  vec3 back = 2.0 * body.x * (ahead + vec3(0.0, 0.0, way.z / sqrt(ior * ior - way.z * way.z)));
  off += way * ((body.x - dot(place, ahead)) / level) - back;
  to = length(back);
  way = back / to;
  return vec2(0.0, letThrough(level, ior));
}
`;

const ROUND = `
struct Landing { float place, growth, sinTurn, cosTurn, sinOut, cosOut; };

/* Of a beam that meets a disc of radius 1 so far off the axis, on a line so far away from its middle. */
Landing landing(float beta, float ior, float away) {
  float cosI = sqrt(max(1.0 - beta * beta, 0.0)), sinR = beta / ior;
  float cosR = sqrt(1.0 - sinR * sinR);
  float sine = beta * cosR - cosI * sinR, cosine = cosI * cosR + beta * sinR; // of half the turn
  float sinTurn = 2.0 * sine * cosine, cosTurn = 1.0 - 2.0 * sine * sine;
  float sinOut = sinR * cosine - cosR * sine, cosOut = cosR * cosine + sinR * sine;
  float tangent = sinTurn / cosTurn, reach = away - cosOut;
  float di = 1.0 / max(cosI, 1e-15), dr = 1.0 / (ior * cosR);
  float growth = 2.0 * (di - dr) * (1.0 + tangent * tangent) * reach + (2.0 * dr - di) * (tangent * sinOut - cosOut);
  return Landing(tangent * reach - sinOut, growth, sinTurn, cosTurn, sinOut, cosOut);
}

/* How far off the axis the beam meets the disc that lands at a place beyond the focus; below 0 where none does. */
float meeting(float place, float ior, float away) {
  float quarter = sqrt(0.5);
  bool strong = ior > sqrt(2.0);
  float low = 0.0, high = strong ? min(ior * quarter / length(vec2(quarter, ior - quarter)), 1.0) : 1.0;
  if (!strong && landing(high, ior, away).place <= place) return -1.0;
  float beta = min(place / (away * 2.0 * (1.0 - 1.0 / ior) - 1.0), 0.9 * high);
  for (int i = 0; i < 40; i++) {
    Landing found = landing(beta, ior, away);
    if (found.place > place) high = beta;
    else low = beta;
    float next = beta - (found.place - place) / found.growth;
    if (abs(next - beta) < 2e-7) return clamp(next, 0.0, 1.0);
    beta = next > low && next < high ? next : 0.5 * (low + high);
  }
  return beta;
}
`;

const CYLINDER = `
vec2 bend(float ior, vec3 whole, vec3 normal, float travelled, inout vec3 off, inout vec3 way, out float to) {
  vec3 light = way;
  vec3 middle = 0.5 * vec3(textureSize(voxels, 0)) - whole; // of the cube, as off counts
  vec3 place = off - middle + travelled * way;
  float level = length(way.xy), radius = body.x, slope = way.z / level;
  vec2 ahead = way.xy / level, left = vec2(-ahead.y, ahead.x);
  float away = dot(place.xy, ahead) / radius, aside = dot(place.xy, left) / radius, beside = 1.0;
  to = 0.0;
  if (abs(aside) < 1.0) {
    float chord = sqrt(1.0 - aside * aside);
    float one = place.z - slope * radius * (away + chord), two = place.z - slope * radius * (away - chord);
    beside = min(one, two) > body.z || max(one, two) < -body.z ? 1.0 : 0.0;
  }
  float index = sqrt(ior * ior - way.z * way.z) / level;
  float beta = meeting(abs(aside), index, away);
  if (beta < 0.0) return vec2(beside, 0.0);
  Landing met = landing(beta, index, away);
  float side = aside > 0.0 ? -1.0 : 1.0, root = sqrt(max(1.0 - beta * beta, 0.0));
  float leaves = place.z - slope * radius * (away - met.cosOut) / met.cosTurn;
  float chord = 2.0 * radius * sqrt(1.0 - pow(beta / index, 2.0));
  float enters = leaves - chord * way.z / sqrt(ior * ior - way.z * way.z);
  if (abs(leaves) >= body.z || abs(enters) >= body.z) return vec2(beside, 0.0);
  vec3 goes = vec3(level * (met.cosTurn * ahead - side * met.sinTurn * left), way.z);
  float aslant = abs(dot(goes, normal)) / abs(dot(light, normal));
  vec2 start = radius * (-root * ahead + side * beta * left);
  vec2 end = radius * (met.cosOut * ahead + side * met.sinOut * left);
  vec3 inside = vec3(end - start, leaves - enters);
  off = vec3(start, enters) + middle;
  to = length(inside);
  way = inside / to;
  return vec2(beside, letThrough(level * root, ior) / (met.growth * met.cosTurn) * aslant);
}
`;

const SPHERE = `
vec2 bend(float ior, vec3 whole, vec3 normal, float travelled, inout vec3 off, inout vec3 way, out float to) {
  vec3 light = way;
  vec3 middle = 0.5 * vec3(textureSize(voxels, 0)) - whole; // of the cube, as off counts
  float radius = body.x, away = travelled / radius;
  vec3 left = (off - middle) / radius; // its start is where it is nearest to the middle
  float aside = length(left), beside = aside >= 1.0 ? 1.0 : 0.0;
  if (aside > 0.0) left /= aside;
  to = 0.0;
  float beta = meeting(aside, ior, away);
  if (beta < 0.0) return vec2(beside, 0.0);
  Landing met = landing(beta, ior, away);
  float root = sqrt(max(1.0 - beta * beta, 0.0)), wider = aside < 1e-5 ? met.growth : aside / beta;
  vec3 goes = met.cosTurn * light + met.sinTurn * left;
  float aslant = abs(dot(goes, normal)) / abs(dot(light, normal));
  vec3 start = radius * (-root * light - beta * left);
  vec3 inside = radius * (met.cosOut * light - met.sinOut * left) - start;
  off = start + middle;
  to = length(inside);
  way = inside / to;
  return vec2(beside, letThrough(root, ior) / (wider * met.growth * met.cosTurn) * aslant);
}
`;
