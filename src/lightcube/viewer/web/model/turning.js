// The turntable in time: at rest, in the hand, on its way to an angle, running out, or playing.

import { modulo } from "../tools/vectors.js";

/** Degrees per second of playing at speed 1. */
export const PLAY_SPEED = 24;
/** Seconds in which a turn that was let go loses most of its speed. */
const RUN_OUT = 0.28;
/** Degrees per second below which nothing seems to move, so that it stops at once. */
const CREEP = 9;
/** Part of the time between two stops that is spent at rest on them while playing. */
const LINGER = 0.5;
/** Stops nearer to the angle than this, in degrees, are where it stands. */
const ON_STOP = 1e-3;

/** Degrees from one angle to another, the shortest way: in [-180, 180). */
export function shortestWay(from, to) {
  return modulo(to - from + 180, 360) - 180;
}

/** Which of the stops (ascending angles) is nearest to an angle. */
export function nearestOf(stops, angle) {
  let best = 0;
  for (let i = 1; i < stops.length; i++) {
    if (Math.abs(shortestWay(angle, stops[i])) < Math.abs(shortestWay(angle, stops[best])) - 1e-9) best = i;
  }
  return best;
}

/** Which of the stops follows (`way` 1) or precedes (-1) an angle, around the turn. */
export function neighbourOf(stops, angle, way) {
  const ahead = stops.map((stop) => modulo(way * (stop - angle), 360));
  const away = ahead.map((gap) => (gap < ON_STOP || gap > 360 - ON_STOP ? 360 : gap));
  return away.indexOf(Math.min(...away));
}

/** How far between two stops one is while playing, after a part of the time: both in 0..1, at rest at the ends. */
function lingering(part) {
  const moved = Math.min(1, Math.max(0, (part - LINGER / 2) / (1 - LINGER)));
  return moved * moved * (3 - 2 * moved);
}

/** The part of the time at which `lingering` is so far. */
function timeOf(far) {
  const moved = 0.5 - Math.sin(Math.asin(1 - 2 * Math.min(1, Math.max(0, far))) / 3);
  return LINGER / 2 + moved * (1 - LINGER);
}

/** The turntable: `step` moves it in time; who takes it into the hand ends whatever moved it. */
export class Turning {
  /**
   * @param {number[]} stops ascending angles of the pictures, degrees
   * @param {boolean} calm go to places at once instead of gliding there
   */
  constructor(stops, calm) {
    this.stops = stops;
    this.calm = calm;
    this.angle = stops[0];
    this.speed = 1;
    this.snap = true;
    this.playing = false;
    this.motion = null;
  }

  /** Whether `step` would change anything. */
  get moving() {
    return this.motion !== null;
  }

  /** Stand at an angle, at rest. */
  set(angle) {
    this.halt();
    this.angle = modulo(angle, 360);
  }

  /** End whatever moves it. */
  halt() {
    this.motion = null;
    this.playing = false;
  }

  /** Turn by hand. */
  push(degrees) {
    this.set(this.angle + degrees);
  }

  /** Go to an angle the shortest way, softly, in so many seconds. */
  glideTo(angle, lasts = 0.3 + Math.abs(shortestWay(this.angle, angle)) / 240) {
    const start = this.angle;
    const way = shortestWay(start, angle);
    let past = 0;
    this.go(angle, (seconds) => {
      past += seconds;
      if (past >= lasts) return true;
      this.angle = modulo(start + way * (0.5 - 0.5 * Math.cos((Math.PI * past) / lasts)), 360);
      return false;
    });
  }

  /** Let go at a speed (degrees per second): it runs out, onto the nearest stop where it snaps. */
  release(speed) {
    const rest = this.angle + (this.calm ? 0 : speed * RUN_OUT);
    const target = this.snap ? this.stops[nearestOf(this.stops, modulo(rest, 360))] : rest;
    // the way on from here may be longer than half a turn
    let left = this.snap ? rest - this.angle + shortestWay(modulo(rest, 360), target) : rest - this.angle;
    this.go(target, (seconds) => {
      const by = Math.max(Math.abs(left) / RUN_OUT, CREEP) * seconds;
      if (by >= Math.abs(left)) return true;
      this.angle = modulo(this.angle + Math.sign(left) * by, 360);
      left -= Math.sign(left) * by;
      return false;
    });
  }

  /** Move by a function of the seconds since it was last called, true when the target is reached. */
  go(target, moved) {
    this.halt();
    const there = modulo(target, 360);
    if (this.calm || Math.abs(shortestWay(this.angle, there)) < 1e-9) {
      this.angle = there;
      return;
    }
    this.motion = (seconds) => {
      if (!moved(seconds)) return;
      this.motion = null;
      this.angle = there;
    };
  }

  /** Turn on and on; where it snaps, with a rest on every stop and as fast on the whole. */
  play() {
    this.halt();
    this.playing = true;
    let part = null;
    let from = 0;
    this.motion = (seconds) => {
      const by = PLAY_SPEED * this.speed * seconds;
      if (!this.snap || this.stops.length < 2) {
        part = null;
        this.angle = modulo(this.angle + by, 360);
        return;
      }
      if (part === null) [from, part] = this.between();
      let gap = this.gapAfter(from);
      for (part += by / gap; part >= 1; gap = this.gapAfter(from)) {
        from = (from + 1) % this.stops.length;
        part = ((part - 1) * gap) / this.gapAfter(from);
      }
      this.angle = modulo(this.stops[from] + gap * lingering(part), 360);
    };
  }

  /** Move on by some seconds. */
  step(seconds) {
    if (this.motion !== null) this.motion(seconds);
  }

  /** Degrees from a stop (by its number) to the next one. */
  gapAfter(stop) {
    return modulo(this.stops[(stop + 1) % this.stops.length] - this.stops[stop], 360) || 360;
  }

  /** The stop before the angle, and the part of the time to the next one that has passed there. */
  between() {
    const nearest = nearestOf(this.stops, this.angle);
    const on = Math.abs(shortestWay(this.angle, this.stops[nearest])) < ON_STOP;
    const from = on ? nearest : neighbourOf(this.stops, this.angle, -1);
    return [from, on ? LINGER / 2 : timeOf(modulo(this.angle - this.stops[from], 360) / this.gapAfter(from))];
  }
}
