// The renderer's programs in GLSL ES 3.00: light through the cube, what the screens show, and the room.

import { JUDGED } from "../model/area.js";
import { bendingOf } from "./bending.js";
import { BODY } from "./solid.js";

const HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
precision highp usampler3D;
`;

/** One triangle that covers everything. */
export const EVERYWHERE = `#version 300 es
void main() {
  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}`;

/** Display values and linear light: IEC 61966-2-1. */
const TRANSFER = `
vec3 toDisplay(vec3 light) {
  vec3 powered = 1.055 * pow(max(light, 0.0031308), vec3(1.0 / 2.4)) - 0.055;
  return mix(powered, light * 12.92, lessThanEqual(light, vec3(0.0031308)));
}

vec3 toLinear(vec3 shown) {
  vec3 powered = pow((max(shown, 0.04045) + 0.055) / 1.055, vec3(2.4));
  return mix(powered, shown / 12.92, lessThanEqual(shown, vec3(0.04045)));
}
`;

/**
 * `absorbed`: the exact absorbance of a ray's stretch through the voxels, by colour.
 *
 * The ray is base + off + t way, in voxel sides from the cube's lowest corner, and way has length 1. Its start has a
 * whole part and a small rest, and each crossing follows from the number of its plane, so that single precision is
 * enough for rays that run almost along a face.
 */
const GLASS = `
#ifndef LIT
#define LIT(dense, piece)
#endif
uniform usampler3D voxels;
uniform vec3 rates;    // extinction of a code c: least (2 ^ (rates c) - 1), per voxel side
uniform float least;

const float STILL = 1e-8;    // a part of a direction below this is zero
const float ON_FACE = 1e-6;  // nearer to a face than this, a ray runs along it
const float NEVER = 1e30;
const float BLACK = 24.0;    // of so much absorbance no display shows what is behind

float least3(vec3 v) { return min(v.x, min(v.y, v.z)); }
float most3(vec3 v) { return max(v.x, max(v.y, v.z)); }

vec3 walked(ivec3 base, vec3 off, vec3 way, float from, float to) {
  ivec3 shape = textureSize(voxels, 0);
  bvec3 still = lessThan(abs(way), vec3(STILL));
  vec3 per = 1.0 / mix(way, vec3(1.0), still);
  vec3 low = vec3(-base) - off;
  vec3 high = vec3(shape - base) - off;
  if (any(bvec3(still.x && low.x * high.x >= 0.0, still.y && low.y * high.y >= 0.0, still.z && low.z * high.z >= 0.0)))
    return vec3(0.0);
  float t = max(from, most3(mix(min(low * per, high * per), vec3(-NEVER), still)));
  float end = min(to, least3(mix(max(low * per, high * per), vec3(NEVER), still)));
  vec3 sum = vec3(0.0);
  if (!(t < end)) return sum;
  ivec3 cell = clamp(base + ivec3(floor(off + t * mix(way, vec3(0.0), still))), ivec3(0), shape - 1);
  ivec3 stride = ivec3(sign(way));
  ivec3 rise = max(stride, 0) - base;
  for (int left = shape.x + shape.y + shape.z; left >= 0; left--) {
    vec3 next = mix((vec3(cell + rise) - off) * per, vec3(NEVER), still);
    float until = min(least3(next), end);
    vec3 code = vec3(texelFetch(voxels, cell, 0).rgb);
    vec3 dense = exp2(rates * code) - 1.0;
    float piece = max(until - t, 0.0);
    sum += piece * dense;
    LIT(least * dense, piece);
    if (until >= end || least * least3(sum) > BLACK) break;
    t = max(t, until);
    cell += stride * ivec3(lessThanEqual(next, vec3(until)));
  }
  return least * sum;
}

vec3 absorbed(ivec3 base, vec3 off, vec3 way, float from, float to) {
  vec3 whole = round(off);
  base += ivec3(whole);
  off -= whole;
  vec3 along = vec3(lessThan(abs(way), vec3(STILL))) * vec3(lessThan(abs(off), vec3(ON_FACE)));
  int sides = along == vec3(0.0) ? 1 : 8; // along a face: the mean of the rays beside it
  vec3 sum = vec3(0.0);
  for (int i = 0; i < sides; i++) {
    vec3 aside = vec3(i & 1, (i >> 1) & 1, i >> 2) - 0.5;
    sum += walked(base, off + along * aside, way, from, to);
  }
  return sum / float(sides);
}
`;

/**
 * What one screen shows, behind the scene's glass or none, each texel a pixel or a part of one: row 0 of the target is
 * the picture's top. The table's layout is gpu.js's `putBeams`.
 */
export function castProgram(glass) {
  return `${HEAD}${glass ? "#define BENT\n" : ""}${TRANSFER}${GLASS}${bendingOf(glass)}${CAST}`;
}

const CAST = `
uniform sampler2D views;
uniform ivec2 range;   // the first of the screen's views, and after the last
uniform ivec2 window;  // columns and rows that lie on the screen
uniform ivec2 raster;
uniform int parts;     // along a pixel's side
uniform vec2 points[${JUDGED.square}];  // of a part's beams, from its middle, in its sides
uniform int beams;     // how many
uniform bool linear;   // display values are linear light
out vec4 shown;

float fading(float distance, float reach, float falloff) {
  float beyond = max(distance - reach, 0.0);
  return falloff == 0.0 ? float(beyond <= 0.0) : exp(-beyond / falloff);
}

/* At a place of a pixel, across and down from its middle. */
vec3 lightOf(int view, ivec2 pixel, vec2 aside) {
  int row = 5 * view;
  vec4 light = texelFetch(views, ivec2(0, row + 4), 0);
  vec4 power = texelFetch(views, ivec2(2, row + 4), 0);
  if (power.rgb == vec3(0.0)) return vec3(0.0);
  vec4 rest = texelFetch(views, ivec2(1, row + 4), 0);
  vec4 fades = texelFetch(views, ivec2(3, row + 4), 0);
  vec4 normal = texelFetch(views, ivec2(4, row + 4), 0);
  vec3 whole = texelFetch(views, ivec2(pixel.x, row), 0).xyz + texelFetch(views, ivec2(pixel.y, row + 2), 0).xyz;
  vec3 off = texelFetch(views, ivec2(pixel.x, row + 1), 0).xyz + texelFetch(views, ivec2(pixel.y, row + 3), 0).xyz;
  vec4 across = texelFetch(views, ivec2(6, row + 4), 0);
  off += aside.x * across.xyz + aside.y * texelFetch(views, ivec2(7, row + 4), 0).xyz;
  vec3 way = light.xyz;
  float from = -NEVER, to = NEVER, travelled;
  float strength = 1.0;
  if (light.w == 0.0) {
    vec3 along = texelFetch(views, ivec2(5, row + 4), 0).xyz;
    vec2 place = vec2(pixel) - 0.5 * vec2(raster - 1) + aside;
    travelled = along.x + place.x * along.y + place.y * along.z;
  } else {
    way = (whole - light.xyz) + (off - rest.xyz);
    float gone = max(length(way), 1e-12);
    way /= gone;
    from = -gone;
    to = gone * rest.w - gone;
    travelled = dot(way, whole + off - 0.5 * vec3(textureSize(voxels, 0))) + to;
    if (normal.w < NEVER) strength = pow(normal.w / (gone * rest.w), 2.0);
  }
  if (power.w != 0.0) strength *= abs(dot(way, normal.xyz));
  float shadow = fading(travelled, fades.x, fades.y) * fading(travelled, fades.z, fades.w);
#ifdef BENT
  vec2 falls = bend(texelFetch(views, ivec2(5, row + 4), 0).w, whole, normal.xyz, travelled, off, way, to);
  from = 0.0;
  strength *= falls.x + falls.y;
  shadow *= falls.y / max(falls.x + falls.y, 1e-20);
#endif
  vec3 passed = exp(-absorbed(ivec3(whole), off, way, from, to));
  return power.rgb * (strength * (1.0 - shadow * (1.0 - passed)) + across.w);
}

void main() {
  ivec2 part = ivec2(gl_FragCoord.xy), pixel = part / parts;
  vec2 middle = (vec2(part % parts) + 0.5) / float(parts) - 0.5;
  vec3 sum = vec3(0.0);
  if (all(lessThan(pixel, window)))
    for (int i = 0; i < beams; i++)
      for (int view = range.x; view < range.y; view++) sum += lightOf(view, pixel, middle + points[i] / float(parts));
  vec3 mean = clamp(sum / float(beams), 0.0, 1.0);
  shown = vec4(linear ? mean : toDisplay(mean), 1.0);
}`;

/** Screens whose light is drawn in the air at most: more would hide the room. */
export const MOST_BEAMS = 6;

/** Glass that shines under the lamp, seen front to back as a ray walks through it. */
const EMBERS = `
vec3 embers = vec3(0.0);  // light that the glass itself throws to the eye, so far
float unveiled = 1.0;     // and how much of what lies behind still does

/* A voxel under the lamp shines in its own colour, the purer the more; one that is black or clear does not. */
void shine(vec3 dense, float piece) {
  float most = max(dense.x, max(dense.y, dense.z)), grey = min(dense.x, min(dense.y, dense.z));
  float pure = most - grey;
  if (pure <= 0.0) return;
  float part = 1.0 - exp(-piece * 0.1 * log(1.0 + 6.0 * pure));
  embers += unveiled * part * (most - dense) / pure;
  unveiled *= 1.0 - part;
}
#define LIT(dense, piece) shine(dense, piece)
`;

/**
 * The room, around glass or around a body; of glass that is cut `round` the block's faces are not seen. All places are mm from the eye; a ray is t way, and t the depth along the camera's axis. Layers lie on the
 * light behind the cube's glass, or on a veil before it. The things' layout is gpu.js's `thingTable`.
 */
export function roomProgram(solid, round) {
  return `${HEAD}precision highp sampler3D;\n${solid ? "#define SOLID\n" : ""}${round ? "#define CUT\n" : ""}${ROOM}`;
}

const ROOM = `${TRANSFER}${EMBERS}${GLASS}
const int MOST_BEAMS = ${MOST_BEAMS};
uniform vec2 canvas;      // pixels
uniform mat3 sight;       // to the right edge, to the upper edge, ahead
uniform mat3 inCube;      // mm in the room to voxel sides in the cube
uniform ivec3 eyeWhole;   // the eye in the cube
uniform vec3 eyeRest;
uniform vec3 ground;      // a point of the floor below the cube's middle
uniform float unit;       // the cube's longest side
uniform mat3 table;       // the disc's middle, and two radii that turn with the cube
uniform vec3 foot;        // half the sides of what stands on the disc, in its radii, and how strong its shadow is
layout(std140) uniform Things { vec4 things[1024]; };  // four numbers of four for each thing
uniform ivec3 counts;     // screens, lamps, lines
uniform sampler2DArray shadows;
uniform float parts;      // of theirs along a pixel's side
uniform vec3 floorTone, farTone, gridTone, tableTone, rimTone, wallTone, backTone, offTone, markTone;
uniform float shade;      // how dark shadows on the floor are
uniform vec3 middle;      // of the cube
uniform vec4 beams[MOST_BEAMS];  // of each screen its brightest lamp: how its light goes, 0, or where it is, 1
uniform vec3 beamTones[MOST_BEAMS];  // that lamp's colour; black where no light falls
uniform float glow;       // how much light the air shows
uniform vec3 emberTone;   // of the glass under the lamp; black without one
uniform vec3 bareTone;    // the light of the lamp whose eye one takes, and
uniform float bare;       // 0 glass as one likes to see it, 1 as light goes through it, before bare light
uniform mat3 sheet;       // a corner of the marked row's beams, and two sides
uniform int sheetKind;    // 0 none, 1 of parallel light, 2 of a lamp in that corner
out vec4 shown;

const float FAR = 300.0;  // widths of the cube: farther away numbers are not fine enough

vec3 way, stepX, stepY;   // of this pixel, and on to its neighbours
vec3 light;               // behind the glass
vec4 veil;                // before it: light, and the part that it lets through
float solid, enter, leave;
float first, last;        // where the ray is in the block, whatever stands there
bool onPicture;           // whether the ray ends there, where nothing may cover the exact light

#ifdef SOLID
${BODY}
#endif

struct Place { float depth; vec2 at; vec2 grain; };

/* Where the ray meets a plane, in steps along two of its sides, and how far these go from pixel to pixel. */
Place placeOn(vec3 origin, vec3 right, vec3 down) {
  vec3 normal = cross(right, down);
  float facing = dot(way, normal);
  float depth = dot(origin, normal) / facing;
  vec3 x = depth * (stepX - way * (dot(stepX, normal) / facing));
  vec3 y = depth * (stepY - way * (dot(stepY, normal) / facing));
  mat2x3 sides = mat2x3(cross(down, normal), cross(normal, right)) * (1.0 / dot(normal, normal));
  sides[0] *= sign(dot(sides[0], right));
  sides[1] *= sign(dot(sides[1], down));
  vec2 grain = sqrt(pow(x * sides, vec2(2.0)) + pow(y * sides, vec2(2.0)));
  return Place(depth, (depth * way - origin) * sides, grain);
}

float within(float distance, float grain) { return clamp(0.5 + distance / max(grain, 1e-9), 0.0, 1.0); }

void lay(vec3 colour, float part, float depth) {
  if (depth <= 0.0 || depth > solid) return;
  if (depth > enter) light = mix(light, colour, part);
  else veil = vec4(mix(veil.rgb, colour, part), veil.a * (1.0 - part));
}

/* Thin lines at whole numbers, fading where they are too fine to be seen. */
float lineAt(float place, float half_, float grain) {
  return within(half_ - abs(place - round(place)), grain) * clamp(1.5 - 4.0 * grain, 0.0, 1.0);
}

float blob(float distance, float height, float size) {
  float soft = size + 0.55 * height;
  return exp(-distance * distance / (soft * soft)) * size / soft;
}

vec3 backdrop() {
  float rise = clamp(way.z / length(way), 0.0, 1.0);
  return farTone * (1.0 + 0.35 * smoothstep(0.0, 0.7, rise));
}

void drawFloor() {
  light = backdrop();
  solid = NEVER;
  Place place = placeOn(ground, vec3(unit, 0.0, 0.0), vec3(0.0, unit, 0.0));
  if (way.z >= 0.0 || place.depth > FAR * unit) return;
  solid = place.depth;
  float away = length(place.at);
  vec2 grain = place.grain;
  float lines = max(lineAt(place.at.x, 0.004, grain.x), lineAt(place.at.y, 0.004, grain.y));
  vec3 tone = mix(floorTone, gridTone, 0.55 * lines);
  tone = mix(farTone, tone, exp(-away * away / 14.0));
  vec3 hover = (table[0] - ground) / unit;
  float radius = length(table[1]) / unit;
  float dark = blob(max(length(place.at - hover.xy) - 0.8 * radius, 0.0), hover.z, 0.24);
  vec3 spill = vec3(0.0); // what the pictures throw back
  for (int i = 0; i < counts.x; i++) {
    vec4 corner = things[4 * i], right = things[4 * i + 1];
    vec3 across = right.xyz * right.w / unit, below = things[4 * i + 2].xyz * corner.w / unit;
    vec3 start = (corner.xyz - ground) / unit + 0.5 * below;
    float part = clamp(dot(place.at - start.xy, across.xy) / max(dot(across.xy, across.xy), 1e-9), 0.0, 1.0);
    float aside = max(length(place.at - start.xy - part * across.xy) - 0.4 * length(below.xy), 0.0);
    float height = max(start.z - 0.5 * abs(below.z) - 0.5 * abs(across.z), 0.0);
    dark = max(dark, 0.7 * blob(aside, height, 0.16));
    vec3 mean = toLinear(textureLod(shadows, vec3(0.5, 0.5, things[4 * i + 2].w), 20.0).rgb);
    spill += 0.5 * glow * mean * exp(-2.5 * aside * aside);
  }
  light = tone * (1.0 - shade * dark) + spill;
}

const float THROUGH = 0.35; // of a picture is seen through the screen's paper from behind

void drawScreen(int i) {
  vec4 corner = things[4 * i], right = things[4 * i + 1];
  vec4 down = things[4 * i + 2], facing = things[4 * i + 3];
  Place place = placeOn(corner.xyz, right.xyz, down.xyz);
  if (place.depth <= 0.0 || place.depth > solid) return;
  vec2 pixels = vec2(right.w, corner.w);
  vec2 edge = 0.5 * pixels - abs(place.at - 0.5 * pixels);
  vec2 wide = facing.w / vec2(length(right.xyz), length(down.xyz)); // of the wall, beyond the picture
  vec2 rim = edge + wide;
  float inside = within(edge.x, place.grain.x) * within(edge.y, place.grain.y);
  float framed = within(rim.x, place.grain.x) * within(rim.y, place.grain.y);
  vec2 spot = clamp(parts * place.at, vec2(0.5), parts * pixels - 0.5) / vec2(textureSize(shadows, 0).xy);
  float coarse = log2(max(parts * max(place.grain.x, place.grain.y), 1.0));
  vec3 tone = toLinear(textureLod(shadows, vec3(spot, down.w), coarse).rgb);
  vec3 mean = toLinear(textureLod(shadows, vec3(0.5, 0.5, down.w), 20.0).rgb);
  vec2 beside = max(-edge, 0.0) / (0.5 * pixels);
  vec3 wall = wallTone + 0.22 * glow * mean * exp(-5.0 * dot(beside, beside));
  if (dot(corner.xyz, facing.xyz) >= 0.0) {
    tone = mix(backTone, tone, THROUGH);
    wall = backTone;
  }
  light = mix(light, mix(wall, tone, inside), framed);
  if (framed <= 0.5) return;
  solid = place.depth;
  onPicture = inside > 0.0;
}

void drawTable(float frost) {
  Place place = placeOn(table[0], table[1], table[2]);
  if (place.depth > FAR * unit) return;
  float radius = length(place.at), grain = max(place.grain.x, place.grain.y);
  float inside = within(1.0 - radius, grain);
  if (inside <= 0.0) return;
  vec2 beside = max(abs(place.at) - foot.xy, 0.0);
  float under = foot.z * exp(-dot(beside, beside) / 0.012);
  lay(tableTone * (1.0 - 0.25 * radius * radius) * (1.0 - shade * under), frost * inside, place.depth);
  float rim = within(radius - 0.985, grain) * inside;
  float turn = atan(place.at.y, place.at.x) / radians(5.0);
  float fine = grain / (radians(5.0) * max(radius, 0.1));
  bool long_ = mod(round(turn), 6.0) == 0.0;
  float marks = lineAt(turn, long_ ? 0.055 : 0.035, fine) * within(radius - (long_ ? 0.925 : 0.95), grain) * inside;
  float zero = within(0.014 - length(place.at - vec2(0.885, 0.0)), grain);
  lay(rimTone, max(max(0.75 * rim, 0.6 * marks), 0.9 * zero), place.depth);
}

void drawLamp(int row) {
  vec4 place = things[4 * row], colour = things[4 * row + 1];
  float away = length(gl_FragCoord.xy - place.xy), radius = place.w;
  if (away > 6.0 * radius + 2.0 || bare > 0.5) return; // there the eye is
  float depth = 1.0 / place.z;
  if (colour.w > 0.0) {
    float far = max(away / radius - 1.0, 0.0);
    lay(colour.rgb, 0.6 * exp(-0.9 * far) * smoothstep(5.0, 2.0, far), depth);
  }
  float core = exp(-1.2 * away * away / (radius * radius));
  vec3 tone = colour.w > 0.0 ? mix(colour.rgb, vec3(1.0), 0.25 + 0.65 * core) : offTone;
  lay(offTone, 0.45 * within(radius + 0.09 * radius - away, 1.0), depth);
  lay(tone, within(radius - away, 1.0), depth);
}

void drawLine(int row) {
  vec4 start = things[4 * row], end = things[4 * row + 1];
  vec2 along = end.xy - start.xy, from = gl_FragCoord.xy - start.xy;
  float part = clamp(dot(from, along) / max(dot(along, along), 1e-9), 0.0, 1.0);
  float cover = clamp(0.5 + 0.5 * start.w - length(from - part * along), 0.0, 1.0);
  if (cover <= 0.0) return;
  vec4 colour = things[4 * row + 2];
  float strength = (1.0 - bare) * cover * mix(colour.w, things[4 * row + 3].x, part);
  float depth = 0.998 / mix(start.z, end.z, part);
  if (end.w == 0.0) lay(colour.rgb, strength, depth);
  else if (depth < solid) veil = vec4(mix(veil.rgb, colour.rgb, strength), veil.a * (1.0 - strength));
}

/* How much of the marked row's sheet of beams the ray meets, and where. */
vec2 metSheet() {
  if (sheetKind == 0) return vec2(0.0, -1.0);
  Place place = placeOn(sheet[0], sheet[1], sheet[2]);
  vec2 at = place.at, grain = place.grain;
  float inside = within(at.x, grain.x) * within(at.y, grain.y);
  if (sheetKind == 1) inside *= within(1.0 - at.x, grain.x) * within(1.0 - at.y, grain.y) * (1.0 - 0.8 * at.y);
  else inside *= within(1.0 - at.x - at.y, grain.x + grain.y);
  return vec2(0.16 * inside, place.depth < solid ? place.depth : -1.0);
}

/* Where the ray is in the light that falls on a screen: from, and to. */
vec2 metBeam(vec4 source, vec3 corner, vec3 across, vec3 below) {
  float from = 0.0, to = solid;
  vec3 inside = corner + 0.5 * (across + below);
  for (int side = 0; side < 4; side++) {
    vec3 along = side % 2 == 0 ? across : below;
    vec3 at = side < 2 ? corner : corner + across + below;
    vec3 normal = cross(along, source.w == 0.0 ? source.xyz : at - source.xyz);
    normal *= sign(dot(normal, inside - at));
    float rate = dot(normal, way), start = dot(normal, at);
    if (rate > 0.0) from = max(from, start / rate);
    else to = min(to, start / rate);
  }
  return vec2(from, to);
}

const int STEPS = 14;

/* The light that dust in the air throws to the eye, behind the glass and before it: white up to the cube, then coloured. */
void drawBeams() {
  if (onPicture) return;
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  float ahead = length(way);
  for (int i = 0; i < min(counts.x, MOST_BEAMS); i++) {
    if (beamTones[i] == vec3(0.0)) continue;
    vec4 corner = things[4 * i], right = things[4 * i + 1], down = things[4 * i + 2], facing = things[4 * i + 3];
    vec3 across = right.xyz * right.w, below = down.xyz * corner.w;
    vec2 met = metBeam(beams[i], corner.xyz, across, below);
    if (met.x >= met.y) continue;
    float piece = (met.y - met.x) / float(STEPS);
    for (int k = 0; k < STEPS; k++) {
      float t = met.x + (float(k) + noise) * piece;
      vec3 place = t * way;
      if (t > first && t < last) continue;
      vec3 source = beams[i].w == 0.0 ? beams[i].xyz : place - beams[i].xyz;
      float left = dot(corner.xyz - place, facing.xyz) / dot(source, facing.xyz);
      if (left < 0.0) continue; // behind the screen
      vec3 hit = place + left * source - corner.xyz;
      vec2 at = vec2(dot(hit, across) / dot(across, across), dot(hit, below) / dot(below, below));
      bool passed = dot(place - middle, source) > 0.0;
      vec2 spot = at * parts * vec2(right.w, corner.w) / vec2(textureSize(shadows, 0).xy);
      float coarse = log2(max(parts * max(right.w, corner.w) / 12.0, 1.0));
      vec3 tone = passed ? toLinear(textureLod(shadows, vec3(spot, down.w), coarse).rgb) : 0.55 * beamTones[i];
      float faint = passed ? 1.0 : exp(-1.2 * length(place - middle) / unit);
      vec3 shine = (1.0 - bare) * glow * faint * tone * piece * ahead / unit;
      if (t > enter) light += shine;
      else veil.rgb += shine;
    }
  }
}

/* Glass whose blacks are dark colours, so that one sees into it. */
vec3 clearer(vec3 absorbance) {
  float grey = least3(absorbance);
  vec3 colour = absorbance - grey;
  return pow(1.0 + grey / 0.8, -0.8) * pow(1.0 + colour / 1.1, vec3(-1.1));
}

vec3 comesThrough(vec3 absorbance) { return mix(clearer(absorbance), exp(-absorbance), bare); }

/* What the face that the ray meets first mirrors of the room. */
void drawSheen() {
  if (enter >= solid || enter <= 0.0) return;
  vec3 inside = inCube * way, start = vec3(eyeWhole) + eyeRest;
  vec3 first = min(-start / inside, (vec3(textureSize(voxels, 0)) - start) / inside);
  vec3 face = vec3(first.x >= most3(first), first.y >= most3(first), first.z >= most3(first));
  float slant = abs(dot(inside, face)) / length(inside);
  float part = (0.03 + 0.5 * pow(1.0 - slant, 4.0)) * (1.0 - bare);
  lay(farTone * 1.6 + 0.06 * face.z, part, enter);
}

/* The light that comes through the glass, past the part of the sheet that lies in it. */
void drawGlass(vec2 beams) {
  vec3 inside = inCube * way;
  float scale = length(inside);
  float last = min(leave, solid);
  light = mix(light, bareTone, enter < leave ? bare : 0.0);
  bool cut = beams.x > 0.0 && beams.y > enter && beams.y < last;
  for (int piece = cut ? 0 : 1; piece < 2; piece++) {
    float from = piece == 0 ? beams.y : enter, to = piece == 1 && cut ? beams.y : last;
    vec3 absorbance = absorbed(eyeWhole, eyeRest, inside / scale, from * scale, to * scale);
    light = light * comesThrough(absorbance) + (1.0 - bare) * emberTone * embers;
    embers = vec3(0.0);
    if (piece == 0) light = mix(light, markTone, beams.x);
  }
  if (!cut) lay(markTone, beams.x, beams.y);
}

void main() {
  way = sight * vec3(2.0 * gl_FragCoord.xy / canvas - 1.0, 1.0);
  stepX = sight[0] * (2.0 / canvas.x);
  stepY = sight[1] * (2.0 / canvas.y);
  veil = vec4(0.0, 0.0, 0.0, 1.0);
  vec3 inside = inCube * way, start = vec3(eyeWhole) + eyeRest;
  vec3 one = -start / inside, other = (vec3(textureSize(voxels, 0)) - start) / inside;
  enter = max(most3(min(one, other)), 0.0);
  leave = least3(max(one, other));
  drawFloor();
  vec2 off = gl_FragCoord.xy / canvas - 0.5;
  light *= 1.0 - 0.42 * dot(off, off);
  float open = solid;
  onPicture = false;
  for (int i = 0; i < counts.x; i++) drawScreen(i);
  bool plain = solid == open;
  first = enter;
  last = leave;
#ifdef SOLID
  enter = leave = NEVER;
  drawBody();
#endif
  if (!(enter < leave && enter < solid)) enter = leave = NEVER;
  drawTable(plain ? 0.68 : 0.1);
  for (int i = 0; i < counts.z; i++) drawLine(counts.x + counts.y + i);
  for (int i = 0; i < counts.y; i++) drawLamp(counts.x + i);
  vec2 sheetMet = metSheet();
  drawBeams();
#ifdef SOLID
  lay(markTone, sheetMet.x, sheetMet.y);
#else
  drawGlass(sheetMet);
#ifndef CUT
  drawSheen();
#endif
#endif
  vec3 seen = toDisplay(clamp(veil.rgb + veil.a * light, 0.0, 1.0));
  // gradients without steps: noise of half a level (J. Jimenez, Next generation post processing, 2014)
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
  shown = vec4(plain ? seen + noise / 255.0 : seen, 1.0);
}`;
