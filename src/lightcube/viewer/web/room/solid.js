// The renderer's program for the body of an opaque shape, in GLSL ES 3.00: a part of the room's program.

import { AMBIENT, HALVINGS, LIFT, MARGIN, SKY, STEP, SURFACE } from "../model/body.js";

/** A number as these programs have it. */
function real(value) {
  return value.toFixed(4);
}

/**
 * The body of an opaque shape: where the ray meets it, and how bright it is there. The same law as in body.js.
 */
export const BODY = `
uniform sampler3D body;   // levels inside, with a margin
uniform vec3 bodyTone;

float levelAt(vec3 place) { return texture(body, (place + ${real(MARGIN)}) / vec3(textureSize(body, 0))).r - ${real(SURFACE / 255)}; }

/* How far a ray goes until it meets the body, in voxel sides; its way has length 1. */
float metBody(vec3 start, vec3 ahead) {
  vec3 along = mix(ahead, vec3(1e-9), lessThan(abs(ahead), vec3(1e-9)));
  vec3 one = (vec3(-1.0) - start) / along, other = (vec3(textureSize(voxels, 0)) + 1.0 - start) / along;
  float from = max(most3(min(one, other)), 0.0), to = least3(max(one, other));
  for (float far = from; far < to; far += ${real(STEP)}) {
    if (levelAt(start + far * ahead) < 0.0) continue;
    float before = max(from, far - ${real(STEP)}), inside = far;
    for (int i = 0; i < ${HALVINGS}; i++) {
      float middle = 0.5 * (before + inside);
      if (levelAt(start + middle * ahead) < 0.0) before = middle;
      else inside = middle;
    }
    return inside;
  }
  return NEVER;
}

vec3 brightness(vec3 place, vec3 normal, vec3 seen) {
  vec3 bright = vec3(0.0), whole = vec3(0.0);
  for (int i = 0; i < min(counts.x, MOST_BEAMS); i++) {
    if (beamTones[i] == vec3(0.0)) continue;
    whole += beamTones[i];
    vec3 toLamp = normalize(inCube * (beams[i].w == 0.0 ? -beams[i].xyz : beams[i].xyz - seen));
    float slant = dot(normal, toLamp);
    if (slant <= 0.0 || metBody(place + ${real(LIFT)} * normal, toLamp) < NEVER) continue;
    bright += slant * beamTones[i];
  }
  float sky = ${real(AMBIENT)} + ${real(SKY)} * (0.5 + 0.5 * dot(normal, normalize(inCube * vec3(0.0, 0.0, 1.0))));
  return min(sky + ${real(1 - AMBIENT - SKY)} * bright / sqrt(max(whole, vec3(1.0))), vec3(1.0));
}

/* The body, which hides what is behind it; for the lamp's own eye it is black before bare light. */
void drawBody() {
  if (first < last) light = mix(light, bareTone, bare);
  vec3 start = vec3(eyeWhole) + eyeRest, inside = inCube * way;
  float far = metBody(start, normalize(inside)), depth = far / length(inside);
  if (far >= NEVER || depth >= solid) return;
  vec3 place = start + far * normalize(inside);
  vec3 ahead = vec3(levelAt(place - vec3(1.0, 0.0, 0.0)) - levelAt(place + vec3(1.0, 0.0, 0.0)),
    levelAt(place - vec3(0.0, 1.0, 0.0)) - levelAt(place + vec3(0.0, 1.0, 0.0)),
    levelAt(place - vec3(0.0, 0.0, 1.0)) - levelAt(place + vec3(0.0, 0.0, 1.0)));
  vec3 normal = dot(ahead, ahead) > 0.0 ? normalize(ahead) : vec3(0.0, 0.0, 1.0);
  light = (1.0 - bare) * bodyTone * brightness(place, normal, depth * way);
  solid = depth;
  onPicture = false;
}
`;
