// The report: pictures of a run or a sweep over time, before and after, and the curves of its probes.
class Report {
  constructor(data) {
    Object.assign(this, { data, pictures: new Map(), index: 0, playing: 0, held: false });
    $("title").textContent = data.title;
    document.title = `${data.title} - sungaze`;
    $("keys").textContent = "Drag over the picture to compare with before. Keys: left and right one frame, space plays, hold B for before, escape ends comparing.";
    $("words").append(...inWords(data.report));
    this.listen();
    this.offerCases();
    this.open(0);
  }

  offerCases() {
    $("cases").hidden = this.data.cases.length < 2;
    $("case").append(...this.data.cases.map((one, i) => make("option", { value: i }, one.name || `case ${i}`)));
    $("case").addEventListener("change", () => this.open(Number($("case").value)));
  }

  open(number) {
    this.case = this.data.cases[number];
    const { frames } = this.case;
    $("time").max = frames.length - 1;
    $("stage").hidden = !frames.some((frame) => frame.picture);
    this.draw_curves();
    this.go(Math.min(this.index, frames.length - 1));
  }

  /** The columns of the table of probes, probe by probe. */
  probes() {
    const { columns, rows } = this.case.probes;
    const column = Object.fromEntries(columns.map((name, i) => [name, i]));
    const found = new Map();
    for (const row of rows) {
      const name = row[column.probe];
      if (!found.has(name)) found.set(name, []);
      found.get(name).push(row);
    }
    const time = "time_s" in column ? "time_s" : "duration_s";
    const of = (rows, key) => rows.map((row) => row[column[key]]);
    return [...found].map(([name, rows]) => ({ name, times: of(rows, time), of: (key) => of(rows, key) }));
  }

  draw_curves() {
    const pick = (time) => this.go(this.nearest(time));
    this.charts = [];
    const groups = this.probes().map((probe) => {
      const group = make("div", { class: "probe", role: "group", "aria-label": `Probe ${probe.name}` }, make("h2", {}, `Probe: ${probe.name}`));
      const kinds = [
        { title: "Unbleached pigment p", curves: ["L", "M", "S"], range: [0, 1], keys: ["p_L", "p_M", "p_S"] },
        { title: "Luminance of the percept Y (cd/m\u00b2)", curves: ["Y"], keys: ["Y"] },
        { title: "Chromaticity of the percept x, y", curves: ["x", "y"], range: [0, 0.8], keys: ["x", "y"] },
      ];
      for (const kind of kinds) {
        const chart = new Chart(group, { ...kind, pick });
        chart.set(probe.times, kind.keys.map((key) => probe.of(key)));
        this.charts.push(chart);
      }
      return group;
    });
    $("curves").replaceChildren(...groups);
  }

  nearest(time) {
    return nearest(this.case.frames.map((frame) => frame.time_s), time);
  }

  picture(name) {
    if (!name) return null;
    if (!this.pictures.has(name)) {
      const image = new Image();
      image.addEventListener("load", () => this.paint());
      image.src = name;
      this.pictures.set(name, image);
      if (this.pictures.size > 40) this.pictures.delete(this.pictures.keys().next().value);
    }
    const image = this.pictures.get(name);
    return image.complete && image.naturalWidth ? image : null;
  }

  go(index) {
    if (!this.case.frames.length) return;
    this.index = Math.max(0, Math.min(this.case.frames.length - 1, index));
    const frame = this.case.frames[this.index];
    $("time").value = this.index;
    $("clock").textContent = seconds(frame.time_s);
    $("time").setAttribute("aria-valuetext", `${seconds(frame.time_s)}, frame ${frame.frame}`);
    const numbers = [`frame ${frame.frame}, ends at ${seconds(frame.time_s)}`];
    if (frame.pupil_mm) numbers.push(`pupil ${short(frame.pupil_mm)} mm`);
    const pictured = this.pictured(this.index);
    if (pictured !== frame && pictured.picture) numbers.push(`picture of ${seconds(pictured.time_s)}`);
    if (frame.adapting_cd_m2) numbers.push(`adapting to ${short(frame.adapting_cd_m2)} cd/m\u00b2`);
    $("lead").textContent = numbers.join(", ");
    this.charts.forEach((chart) => chart.read(frame.time_s));
    for (let i = 1; i <= 3; i++) this.picture(this.case.frames[this.index + i]?.picture);
    this.paint();
  }

  /** The frame whose picture stands for one: its own, the last before it, or the first there is. */
  pictured(index) {
    const { frames } = this.case;
    const had = (frame) => frame.picture;
    return frames.slice(0, index + 1).reverse().find(had) ?? frames.find(had) ?? frames[index];
  }

  paint() {
    const frame = this.pictured(this.index);
    const before = this.picture(this.case.before);
    const after = this.picture(frame.picture);
    const wipe = this.held ? 1 : Number($("wipe").value) / 100;
    if (after || wipe === 1) stage.draw(before, after, wipe);
    stage.mark($("marks").checked ? frame.gaze : null, false);
    $("canvas").setAttribute("aria-label", `The picture as the eye sees it after ${seconds(frame.time_s)}`);
  }

  play(on) {
    clearInterval(this.playing);
    this.playing = on ? setInterval(() => (this.index + 1 < this.case.frames.length ? this.go(this.index + 1) : this.play(false)), 120) : 0;
    $("play").textContent = on ? "Pause" : "Play";
  }

  toggle() {
    if (!this.playing && this.index + 1 === this.case.frames.length) this.go(0);
    this.play(!this.playing);
  }

  hold(on) {
    this.held = on;
    this.paint();
  }

  /** Shows the picture before, left of a share of the width in per cent. */
  wipe(share) {
    $("wipe").value = share;
    this.paint();
  }

  listen() {
    $("time").addEventListener("input", () => this.go(Number($("time").value)));
    $("wipe").addEventListener("input", () => this.paint());
    $("marks").addEventListener("change", () => this.paint());
    $("play").addEventListener("click", () => this.toggle());
    const drag = (event) => {
      if (!event.buttons) return;
      this.wipe(100 * stage.fractions(event)[0]);
    };
    $("stage").addEventListener("pointerdown", drag);
    $("stage").addEventListener("pointermove", drag);
    document.addEventListener("keydown", (event) => this.key(event));
    document.addEventListener("keyup", (event) => event.key.toLowerCase() === "b" && this.hold(false));
  }

  key(event) {
    if (typing(event)) return;
    const steps = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10, Home: -1e9, End: 1e9 };
    if (event.key in steps) this.go(this.index + steps[event.key]);
    else if (event.key === " " && event.target.tagName !== "BUTTON") this.toggle();
    else if (event.key.toLowerCase() === "b" && !event.repeat) this.hold(true);
    else if (event.key === "Escape") this.wipe(0);
    else return;
    event.preventDefault();
  }
}
