// Elements, numbers and the stage: what the report and the live view share. Text from data only ever becomes text nodes.
"use strict";

const $ = (id) => document.getElementById(id);

/** An element with attributes and children; strings become text. */
function make(tag, attributes = {}, ...children) {
  const svg = ["svg", "path", "line", "rect", "text", "g"].includes(tag);
  const element = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children.map((child) => (child instanceof Node ? child : String(child))));
  return element;
}

/** A number for people: three figures, powers of ten where they are shorter. */
function short(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "none";
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-3)) return value.toExponential(2).replace("e+", "e");
  return size >= 100 ? value.toFixed(size >= 1000 ? 0 : 1) : String(Number(value.toPrecision(3)));
}

function seconds(time) {
  return `${time < 10 ? Number(time.toPrecision(3)) : time.toFixed(1)} s`;
}

/** The index of the time nearest to one. */
function nearest(times, wanted) {
  return times.reduce((best, time, i) => (Math.abs(time - wanted) < Math.abs(times[best] - wanted) ? i : best), 0);
}

/** The picture: what is seen, what was there before, and the mark of the gaze. */
const stage = {
  canvas: $("canvas"),
  context: $("canvas").getContext("2d"),

  /** Draws `before` left of the share `wipe` of the width and `after` right of it. */
  draw(before, after, wipe = 0) {
    const size = after || before;
    if (!size) return;
    const [width, height] = [size.naturalWidth || size.width, size.naturalHeight || size.height];
    if (this.canvas.width !== width || this.canvas.height !== height) {
      [this.canvas.width, this.canvas.height] = [width, height];
    }
    const column = Math.round(wipe * width);
    if (after) this.context.drawImage(after, 0, 0, width, height);
    if (before && column > 0) this.context.drawImage(before, 0, 0, column, height, 0, 0, column, height);
    $("edge").hidden = column === 0 || column === width;
    $("edge").style.left = `${100 * wipe}%`;
  },

  /** Marks a gaze, fractions of the picture; `fade`: the mark goes away by itself. */
  mark(gaze, fade) {
    const mark = $("mark");
    mark.hidden = !gaze;
    if (!gaze) return;
    [mark.style.left, mark.style.top] = gaze.map((fraction) => `${100 * fraction}%`);
    mark.classList.remove("faded");
    if (fade) requestAnimationFrame(() => requestAnimationFrame(() => mark.classList.add("faded")));
  },

  /** Where a pointer is, fractions of the picture. */
  fractions(event) {
    const box = this.canvas.getBoundingClientRect();
    const inside = (value) => Math.min(1, Math.max(0, value));
    return [inside((event.clientX - box.left) / box.width), inside((event.clientY - box.top) / box.height)];
  },
};

/** Whether a key is wanted by what has the focus: sliders and radio buttons want arrows and the like, but no letters. */
function typing(event) {
  if (event.ctrlKey || event.altKey || event.metaKey) return true;
  const { tagName, type } = event.target;
  if (tagName === "INPUT") return event.key.length > 1 || (type === "checkbox" && event.key === " ");
  return tagName === "SELECT" || tagName === "SUMMARY";
}
