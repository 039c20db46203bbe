// Curves over time: axes, a cursor, and a legend that reads the curves at the cursor.
/** Where the plot lies in its drawing of 400 by 150. */
const PLOT = { left: 46, right: 392, top: 6, bottom: 122 };

/** Numbers worth a tick between two ends: 1, 2 or 5 times a power of ten apart, or powers of ten. */
function ticks(from, to, logarithmic) {
  if (logarithmic) {
    const [first, last] = [Math.ceil(Math.log10(from) - 1e-9), Math.floor(Math.log10(to) + 1e-9)];
    const every = Math.max(1, Math.ceil((last - first + 1) / 7));
    const powers = [];
    for (let n = first; n <= last; n += every) powers.push(10 ** n);
    return powers;
  }
  const decade = 10 ** Math.floor(Math.log10((to - from) / 3 || 1));
  const step = [1, 2, 5, 10].map((n) => n * decade).find((step) => (to - from) / step <= 5.5);
  const found = [];
  for (let n = Math.ceil(from / step - 1e-9); n * step <= to * (1 + 1e-9); n++) found.push(Number((n * step).toPrecision(12)));
  return found;
}

/** A power of ten, as axes write it. */
function power(value) {
  const exponent = Math.round(Math.log10(value));
  const raised = String(exponent).replace(/./g, (sign) => (sign === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[sign]));
  return exponent >= 0 && exponent <= 3 ? short(value) : `10${raised}`;
}

class Axis {
  constructor(from, to, logarithmic, start, end) {
    Object.assign(this, { from, to, logarithmic, start, end });
  }

  share(value) {
    const of = this.logarithmic ? Math.log : Number;
    return (of(value) - of(this.from)) / (of(this.to) - of(this.from));
  }

  at(value) {
    return this.start + (this.end - this.start) * this.share(value);
  }

  value(place) {
    const share = (place - this.start) / (this.end - this.start);
    return this.logarithmic ? this.from * (this.to / this.from) ** share : this.from + share * (this.to - this.from);
  }
}

class Chart {
  /** `curves`: names, which are also their classes. `range`: ends of the value axis; without it, powers of ten. */
  constructor(host, { title, curves, range, pick }) {
    Object.assign(this, { curves, range, times: [], columns: [] });
    this.readings = curves.map(() => make("output"));
    const sample = (name) => make("svg", { viewBox: "0 0 30 8", "aria-hidden": "true" }, make("path", { class: `curve ${name}`, d: "M0 4H30" }));
    const entries = curves.map((name, i) => make("span", {}, sample(name), `${name} `, this.readings[i]));
    this.axes = make("g");
    this.paths = curves.map((name) => make("path", { class: `curve ${name}` }));
    this.cursor = make("line", { class: "cursor", y1: PLOT.top, y2: PLOT.bottom });
    this.svg = make("svg", { viewBox: "0 0 400 150", role: "img", "aria-label": title }, this.axes, ...this.paths, this.cursor);
    this.broken = make("p", { class: "fine", hidden: "" }, "Lines break where a value lies outside the plot, or the percept is black.");
    host.append(make("div", { class: "chart card" }, make("h3", {}, title), make("div", { class: "legend" }, ...entries), this.svg, this.broken));
    if (pick) this.svg.addEventListener("click", (event) => pick(this.time(event)));
  }

  /** Draws columns of values over rising times. */
  set(times, columns) {
    Object.assign(this, { times, columns });
    const positive = times.filter((time) => time > 0);
    const [first, last] = [positive[0] || 0, times[times.length - 1] || 1];
    const logarithmic = !this.linear && first > 0 && last > 100 * first;
    this.x = new Axis(logarithmic ? first : 0, last, logarithmic, PLOT.left, PLOT.right);
    this.y = this.values(columns);
    this.frame();
    const lines = columns.map((column) => this.line(column));
    this.paths.forEach((path, i) => path.setAttribute("d", lines[i]));
    this.broken.hidden = !lines.some((line) => line.lastIndexOf("M") > 0 || !line);
  }

  values(columns) {
    if (this.range) return new Axis(...this.range, false, PLOT.bottom, PLOT.top);
    const found = columns.flat().filter((value) => value > 0);
    const [least, most] = [found.reduce((a, b) => Math.min(a, b), Infinity), found.reduce((a, b) => Math.max(a, b), 0)];
    if (!found.length) return new Axis(0.1, 10, true, PLOT.bottom, PLOT.top);
    const [low, high] = [Math.floor(Math.log10(least)), Math.ceil(Math.log10(most))];
    return new Axis(10 ** low, 10 ** Math.max(high, low + 1), true, PLOT.bottom, PLOT.top);
  }

  frame() {
    const label = (text, attributes) => make("text", attributes, text);
    const { left, right, top, bottom } = PLOT;
    const across = ticks(this.x.from, this.x.to, this.x.logarithmic).map((time) => [this.x.at(time), short(time)]);
    const words = this.y.logarithmic ? power : short;
    const up = ticks(this.y.from, this.y.to, this.y.logarithmic).map((value) => [this.y.at(value), words(value)]);
    this.axes.replaceChildren(
      make("rect", { class: "frame", x: left, y: top, width: right - left, height: bottom - top }),
      ...across.map(([x]) => make("line", { class: "grid", x1: x, x2: x, y1: top, y2: bottom })),
      ...across.map(([x, text]) => label(text, { x, y: bottom + 14, "text-anchor": x > right - 15 ? "end" : "middle" })),
      ...up.map(([y]) => make("line", { class: "grid", x1: left, x2: right, y1: y, y2: y })),
      ...up.map(([y, text]) => label(text, { x: left - 5, y: y + 4, "text-anchor": "end" })),
      label("time (s)", { x: (left + right) / 2, y: 149, "text-anchor": "middle" }),
    );
  }

  /** The path of a curve; it breaks where there is no value or the value leaves the plot. */
  line(column) {
    let [path, pen] = ["", "M"];
    this.times.forEach((time, i) => {
      const value = column[i];
      const share = value === null || (this.y.logarithmic && value <= 0) ? NaN : this.y.share(value);
      if (!(share >= -1e-6 && share <= 1 + 1e-6) || (this.x.logarithmic && time <= 0)) return void (pen = "M");
      path += `${pen}${this.x.at(time).toFixed(1)} ${this.y.at(value).toFixed(1)}`;
      // A point that stands alone is a dot.
      if (pen === "M") path += "h0";
      pen = "L";
    });
    return path;
  }

  /** Moves the cursor to the sample nearest to a time. */
  read(wanted) {
    if (!this.times.length) return;
    const index = nearest(this.times, wanted);
    const time = this.x.logarithmic ? Math.max(this.times[index], this.x.from) : this.times[index];
    this.cursor.setAttribute("x1", this.x.at(time));
    this.cursor.setAttribute("x2", this.x.at(time));
    this.readings.forEach((reading, i) => (reading.textContent = short(this.columns[i][index])));
  }

  /** The time under a pointer. */
  time(event) {
    const box = this.svg.getBoundingClientRect();
    return this.x.value(((event.clientX - box.left) / box.width) * 400);
  }
}
