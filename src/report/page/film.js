// The motion as files: a picture of the moment, a film of the stretch that the charts show.
import { milliseconds } from "./format.js";
import { theme } from "./theme.js";
import { label } from "./pen.js";

/** Kinds of film, the one that most players know first. */
const KINDS = [
  ["video/webm;codecs=vp9", "webm"],
  ["video/webm;codecs=vp8", "webm"],
  ["video/webm", "webm"],
  ["video/mp4", "mp4"],
];

const FRAMES_PER_SECOND = 30;
const BITS_PER_SECOND = 8e6;

/** How often what comes out of the encoder is looked at (ms), and how often at most. */
const LOOK = 50;
const MOST_LOOKS = 100;

/** A file of no more bytes has no frame in it. */
const EMPTY = 500;

/** How many pieces of the film show the last moment, so that the encoder has not left it out. */
const LAST_PIECES = 5;

/** Height of the line of words over the drawing (CSS pixels). */
const WORDS = 30;

const get = (id) => document.getElementById(id);

export class Film {
  /** `stretch()` tells the stretch (s) that the charts show. */
  constructor(stage, clock, stretch) {
    Object.assign(this, { stage, clock, stretch, recorder: null });
    this.parts = [get("stage"), get("dials")];
    get("picture").addEventListener("click", () => this.savePicture());
    get("film").addEventListener("click", () => (this.recorder ? this.clock.pause() : this.begin()));
    const drawn = stage.drawable.length > 0;
    this.kind = drawn && typeof MediaRecorder !== "undefined" ? KINDS.find(([type]) => MediaRecorder.isTypeSupported(type)) : undefined;
    get("picture").hidden = !drawn;
    get("film").hidden = !this.kind || clock.end <= clock.begin;
    this.tell();
    clock.watch((tick) => this.follow(tick));
    get("speed").addEventListener("change", () => this.tell());
  }

  savePicture() {
    const canvas = this.newCanvas();
    this.compose(canvas);
    canvas.toBlob((blob) => save(blob, `${this.name()}-${milliseconds(this.clock.time)}-ms.png`), "image/png");
  }

  /** Records what is played from the begin of the stretch to its end. */
  async begin() {
    const [from, to] = this.stretch();
    const canvas = this.newCanvas();
    // Encoders want even sides.
    [canvas.width, canvas.height] = [canvas.width & ~1, canvas.height & ~1];
    const [type, ending] = this.kind;
    this.clock.pause();
    this.clock.set(from);
    this.compose(canvas);
    const recorder = new MediaRecorder(canvas.captureStream(FRAMES_PER_SECOND), { mimeType: type, videoBitsPerSecond: BITS_PER_SECOND });
    const chunks = [];
    recorder.addEventListener("dataavailable", ({ data }) => data.size > 0 && chunks.push(data));
    recorder.addEventListener("stop", () => {
      save(new Blob(chunks, { type }), `${this.name()}-${milliseconds(from)}-to-${milliseconds(this.clock.time)}-ms.${ending}`);
      this.tell();
    });
    Object.assign(this, { recorder, canvas, chunks, from, to });
    recorder.start(LOOK);
    this.tell();
    // Encoders take their time to begin; what is played before that is lost.
    await this.showUntil(() => chunks.reduce((sum, { size }) => sum + size, 0) > EMPTY);
    this.clock.play();
  }

  /** Shows the present frame until what has come out of the encoder is enough. */
  async showUntil(enough) {
    for (let look = 0; look < MOST_LOOKS && !enough(); look++) {
      this.compose(this.canvas);
      await new Promise((done) => setTimeout(done, LOOK));
    }
  }

  follow({ time, playing, moved }) {
    if (!this.recorder) return;
    if (time >= this.to || !playing) return this.end();
    if (moved) this.compose(this.canvas);
    this.tell();
  }

  async end() {
    const { recorder, chunks } = this;
    this.recorder = null;
    this.clock.pause();
    this.clock.set(Math.min(this.clock.time, this.to));
    const before = chunks.length;
    await this.showUntil(() => chunks.length >= before + LAST_PIECES);
    recorder.stop();
  }

  tell() {
    const button = get("film");
    const [from, to] = this.recorder ? [this.from, this.to] : this.stretch();
    if (this.recorder) {
      button.textContent = `■ Stop, ${Math.round((100 * (this.clock.time - from)) / (to - from))} %`;
      return;
    }
    const seconds = (to - from) / this.clock.speed;
    button.textContent = `Film (${this.kind?.[1] === "mp4" ? "MP4" : "WebM"})`;
    button.title = `Records the stretch that the charts show, at the speed chosen: ${seconds < 10 ? seconds.toFixed(1) : Math.round(seconds)} s`;
  }

  /** An empty canvas for stage and dials, as they are on the screen. */
  newCanvas() {
    const ratio = window.devicePixelRatio || 1;
    const shown = this.parts.filter((part) => !part.hidden && part.width > 0);
    const canvas = document.createElement("canvas");
    canvas.width = Math.max(...shown.map((part) => part.width));
    canvas.height = Math.round(WORDS * ratio) + shown.reduce((sum, part) => sum + part.height, 0);
    return canvas;
  }

  /** Words, stage and dials on paper. */
  compose(canvas) {
    const ratio = window.devicePixelRatio || 1;
    const pen = canvas.getContext("2d");
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.fillStyle = theme().paper;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    let top = Math.round(WORDS * ratio);
    for (const part of this.parts) {
      if (part.hidden || part.width === 0) continue;
      pen.drawImage(part, (canvas.width - part.width) / 2, top);
      top += part.height;
    }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    label(pen, this.stage.shown.map((run) => run.label).join(", "), 12, WORDS / 2, { weight: "600" });
    label(pen, `t = ${milliseconds(this.clock.time)} ms`, canvas.width / ratio - 12, WORDS / 2, { align: "right" });
  }

  name() {
    const names = this.stage.shown.map((run) => run.label).join("-");
    return names.replace(/[^\p{L}\p{N}_.-]+/gu, "_").slice(0, 80) || "motion";
  }
}

/** Hands a file to the reader. */
function save(blob, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name.replace(/−/g, "-") });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
