// The one time of the page: everything that shows a moment follows it.

/** Slow motions, fastest first. */
export const SPEEDS = [1, 1 / 2, 1 / 5, 1 / 10, 1 / 20, 1 / 50, 1 / 100, 1 / 200, 1 / 500, 1 / 1000, 1 / 2000, 1 / 5000, 1 / 10000, 1 / 20000];

/** Longest time between two frames that counts (s): a tab in the background stands still. */
const LONGEST_FRAME = 0.1;

export class Clock {
  /** A clock from one time to another (s), standing at the first. */
  constructor(begin, end) {
    Object.assign(this, { begin, end, time: begin, playing: false, watchers: [] });
    // Fast enough to be through in 40 s.
    this.speed = SPEEDS.findLast((speed) => (end - begin) / speed <= 40) ?? 1;
  }

  /** Calls back with `{ time, before, playing }` whenever the time or the playing changes. */
  watch(watcher) {
    this.watchers.push(watcher);
  }

  /** Goes to a time (s). */
  set(time) {
    if (!Number.isFinite(time)) return;
    const before = this.time;
    this.time = Math.min(Math.max(time, this.begin), this.end);
    this.tell(before, false);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (this.playing || this.end <= this.begin) return;
    if (this.time >= this.end) this.set(this.begin);
    this.playing = true;
    this.last = performance.now();
    requestAnimationFrame((now) => this.frame(now));
    this.tell(this.time, false);
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.tell(this.time, false);
  }

  frame(now) {
    if (!this.playing) return;
    const passed = Math.min(Math.max(now - this.last, 0) / 1e3, LONGEST_FRAME);
    this.last = now;
    const before = this.time;
    this.time = Math.min(before + passed * this.speed, this.end);
    if (this.time >= this.end) this.playing = false;
    else requestAnimationFrame((next) => this.frame(next));
    this.tell(before, true);
  }

  tell(before, moved) {
    for (const watcher of this.watchers) watcher({ time: this.time, before, playing: this.playing, moved });
  }
}
