// The live view: pictures and words come over one WebSocket, looks and keys go back.

const HEAD = 72;
const SPEEDS = [1, 2, 5, 10, 20, 50, 100];

class Live {
  constructor() {
    Object.assign(this, { looks: 0, gaze: [0.5, 0.5], playing: false, lived: 0, times: [], p: [[], [], []], sent: new Map(), drawn: [] });
    $("title").textContent = "sungaze";
    $("keys").textContent = "Click or drag on the picture to look there. Keys: space runs and pauses, arrows move the gaze (shift: far), hold B for before, R rests the eye.";
    $("time").step = "any";
    $("begin").hidden = false;
    $("begin").focus();
    this.chart = new Chart($("curves"), { title: "Unbleached pigment p at the gaze", curves: ["L", "M", "S"], range: [0, 1], pick: (time) => this.say({ scrub: time }) });
    this.chart.linear = true;
    this.controls = new Controls((keys) => this.say({ set: keys }));
    this.hint("Press the button or the space bar, and keep looking at the light.");
    this.offerSpeeds();
    this.listen();
    this.connect();
  }

  connect() {
    const token = new URLSearchParams(location.hash.slice(1)).get("t") || "";
    this.socket = new WebSocket(`ws://${location.host}/eye`);
    this.socket.binaryType = "arraybuffer";
    this.socket.addEventListener("open", () => this.say({ hello: token }));
    this.socket.addEventListener("message", ({ data }) => (typeof data === "string" ? this.hear(JSON.parse(data)) : this.see(data)));
    this.socket.addEventListener("close", () => this.ended());
  }

  say(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  hint(text) {
    $("hint").textContent = text;
  }

  ended() {
    this.over = true;
    if (!this.taken) this.hint("The program has ended, or this address lacks its token: open the address that `sungaze view` printed.");
    for (const button of document.querySelectorAll("button, input, select")) button.disabled = true;
  }

  /** Words of the eye. */
  hear(words) {
    if (words.note) this.hint(words.note);
    if (words.history) this.remember(words.history);
    if (words.settings) this.settings(words.settings);
    if (words.saved) this.saved(words.saved);
    if (words.taken) {
      this.taken = true;
      this.hint("Another page has taken over. Reload this one to take it back.");
    }
  }

  settings(given) {
    $("title").textContent = given.title;
    $("lead").textContent = given.notes.join("; ");
    document.title = `${given.title} - sungaze view`;
    this.controls.show(given);
    this.offerSaved(given.names);
  }

  saved({ name, folder, looks, names }) {
    this.hint(`Saved ${looks} looks in ${folder}/${name}. "sungaze run ${folder}/${name}/${name}.toml" makes the same pictures.`);
    this.offerSaved(names);
  }

  offerSaved(names) {
    $("saved").replaceChildren(make("option", { value: "" }, "Open saved..."), ...names.map((name) => make("option", {}, name)));
    $("saved").hidden = names.length === 0;
  }

  /** A history of [time, pL, pM, pS]. */
  remember(rows) {
    this.times = rows.map((row) => row[0]);
    this.p = [1, 2, 3].map((k) => rows.map((row) => row[k]));
    this.lived = this.times.at(-1) || 0;
    this.draw();
  }

  /** A picture of the eye: its head is read, it is drawn, and a credit goes back. */
  async see(data) {
    const view = new DataView(data);
    const [seq, id] = [view.getUint32(4, true), view.getUint32(8, true)];
    const float = (i) => view.getFloat32(40 + 4 * i, true);
    const head = { seq, id, playing: view.getUint8(17) === 1, time: view.getFloat64(24, true), p: [float(0), float(1), float(2)], pupil: float(3), fovea: float(4), gaze: [float(5), float(6)] };
    const type = view.getUint8(16) === 2 ? "image/png" : "image/jpeg";
    const picture = await createImageBitmap(new Blob([new Uint8Array(data, HEAD)], { type })).catch(() => null);
    if (!picture) return this.say({ shown: seq });
    requestAnimationFrame(() => {
      // Pictures are decoded side by side: one that a newer has overtaken is not drawn.
      const newest = seq > (this.newest ?? 0);
      if (newest) stage.draw(null, picture);
      picture.close();
      this.say({ shown: seq });
      if (newest) this.met(head);
      this.newest = Math.max(seq, this.newest ?? 0);
    });
  }

  met(head) {
    this.measure(head.id);
    this.playing = head.playing;
    this.begun = head.playing || head.time > 0;
    $("begin").hidden = this.begun;
    if (head.id >= this.looks) this.gaze = head.gaze;
    $("play").textContent = head.playing ? "Pause" : "Play";
    if (head.time > (this.times.at(-1) ?? -1)) {
      this.times.push(head.time);
      head.p.forEach((p, k) => this.p[k].push(p));
      if (this.times.length > 4000) this.thin();
    }
    this.now = head.time;
    this.lived = Math.max(this.lived, head.time);
    this.tell(head);
    if (!this.drawing) this.drawing = setTimeout(() => this.draw(), 120);
  }

  thin() {
    const every = (column) => column.filter((_, i) => i % 2 === 0 || i === column.length - 1);
    this.times = every(this.times);
    this.p = this.p.map(every);
  }

  draw() {
    clearTimeout(this.drawing);
    this.drawing = 0;
    const rested = [[0], [[1], [1], [1]]];
    this.chart.set(...(this.times.length ? [this.times, this.p] : rested));
    this.chart.read(this.now || 0);
    $("time").max = this.lived || 1;
    if (document.activeElement !== $("time") || this.playing) $("time").value = this.now || 0;
    $("time").setAttribute("aria-valuetext", seconds(this.now || 0));
  }

  tell({ time, p, pupil, fovea, gaze }) {
    $("clock").textContent = seconds(time);
    const rows = [
      ["Time", seconds(time)],
      ["Pigment left L, M, S", p.map((v) => short(v)).join(", ")],
      ["Pupil", pupil ? `${pupil.toFixed(2)} mm` : "not yet"],
      ["Fovea sees", pupil ? `${short(fovea)} cd/m\u00b2` : "not yet"],
      ["Gaze", gaze.map((v) => v.toFixed(3)).join(", ")],
      ["Shown", this.rate()],
    ];
    $("numbers").firstElementChild.replaceChildren(...rows.flatMap(([name, value]) => [make("dt", {}, name), make("dd", {}, value)]));
  }

  /** Pictures a second over the last second, and the time from a look to its picture. */
  measure(id) {
    const now = performance.now();
    this.drawn = [...this.drawn.filter((then) => now - then < 1000), now];
    if (this.sent.has(id)) this.delay = now - this.sent.get(id);
    for (const old of this.sent.keys()) if (old <= id) this.sent.delete(old);
  }

  rate() {
    return `${this.drawn.length} pictures/s${this.delay ? `, ${this.delay.toFixed(0)} ms` : ""}`;
  }

  look(gaze) {
    this.gaze = gaze.map((v) => Math.min(1, Math.max(0, v)));
    this.looks += 1;
    this.sent.set(this.looks, performance.now());
    this.say({ look: this.gaze, id: this.looks });
    stage.mark(this.gaze, true);
    if (this.begun) this.hint("The after-image moves with your gaze.");
  }

  play(on) {
    if (on && !this.begun) {
      this.hint("You are staring at the ring. After a few seconds, click somewhere else, or press the arrow keys, to look there.");
    }
    stage.mark(this.gaze, true);
    this.say({ play: on });
    if (on) this.say({ speed: Number(document.querySelector("#speed input:checked").value) });
  }

  rest() {
    this.say({ rest: true });
    [this.times, this.p, this.lived] = [[], [[], [], []], 0];
    this.hint("The eye is rested: all pigment is back.");
  }

  offerSpeeds() {
    const radio = (speed) => {
      const input = make("input", { type: "radio", name: "speed", value: speed, ...(speed === 1 ? { checked: "" } : {}) });
      input.addEventListener("change", () => this.say({ speed }));
      return make("label", {}, input, make("span", {}, `${speed}\u00d7`));
    };
    $("speed").append(...SPEEDS.map(radio));
  }

  listen() {
    const drag = (event) => event.buttons & 1 && event.target !== $("begin") && this.look(stage.fractions(event));
    $("stage").addEventListener("pointerdown", drag);
    $("stage").addEventListener("pointermove", drag);
    $("begin").addEventListener("click", () => this.play(true));
    $("play").addEventListener("click", () => this.play(!this.playing));
    $("rest").addEventListener("click", () => this.rest());
    $("save").addEventListener("click", () => this.say({ save: true }));
    $("saved").addEventListener("change", () => this.reopen($("saved").value));
    $("time").addEventListener("input", () => this.say({ scrub: Number($("time").value) }));
    $("before").addEventListener("pointerdown", () => this.before(true));
    for (const end of ["pointerup", "pointerleave", "blur"]) $("before").addEventListener(end, () => this.before(false));
    document.addEventListener("keydown", (event) => this.key(event));
    document.addEventListener("keyup", ({ key }) => ["b", "B", " ", "Enter"].includes(key) && this.before(false));
  }

  /** Shows the picture before anything has bleached, as long as somebody wants it. */
  before(on) {
    if (Boolean(this.held) === on) return;
    this.held = on;
    this.say({ before: on });
  }

  reopen(name) {
    if (!name) return;
    this.say({ open: name });
    this.hint(`${name} is lived again; play goes on from its end.`);
  }

  key(event) {
    if (this.over || typing(event)) return;
    const step = event.shiftKey ? 0.1 : 0.01;
    const arrows = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
    const key = event.key.toLowerCase();
    if (event.key in arrows) this.look(this.gaze.map((v, i) => v + arrows[event.key][i]));
    else if ((key === " " || key === "enter") && event.target === $("before")) this.before(true);
    else if (key === " " && (event.target.tagName !== "BUTTON" || event.target === $("play"))) this.play(!this.playing);
    else if (key === "b") this.before(true);
    else if (key === "r") this.rest();
    else return;
    event.preventDefault();
  }
}
