// Controls of the live view: keys of the configuration as labelled inputs. A key that this program lacks has no control.

const PUPILS = ["watson-yellott", "moon-spencer", "de-groot-gebhard", "fixed"];
const OPTICS = ["none", "cie", "cie-general", "stiles-holladay", "spencer", "ijspeert"];

/** What can be set live. `again`: the eye lives its path again. `also`: keys that go back to their defaults with it. */
const CONTROLS = [
  { key: "observer.age", label: "Age", unit: "years", range: [20, 80, 1] },
  { key: "observer.pupil", label: "Pupil", choices: () => PUPILS },
  { key: "observer.pupil_mm", label: "Fixed pupil", unit: "mm", range: [1, 9, 0.1], only: ["observer.pupil", "fixed"], default: 3 },
  { key: "observer.constants", label: "Constants", choices: (given) => given.constants, also: ["observer.half_bleach_log_td", "observer.tau_s"] },
  { key: "observer.half_bleach_log_td", label: "Half-bleach L, M", unit: "log td", range: [2, 7, 0.1], of: (v) => v[0], to: (v, old) => [v, v, old[2]] },
  { key: "observer.half_bleach_log_td", label: "Half-bleach S", unit: "log td", range: [2, 7, 0.1], of: (v) => v[2], to: (v, old) => [old[0], old[1], v] },
  { key: "optics.psf", label: "Glare in the eye", choices: () => OPTICS },
  { key: "display.tone", label: "Tone", choices: () => ["ward", "exposure"] },
  { key: "display.exposure_ev", label: "Exposure", unit: "EV", range: [-24, 8, 0.5], only: ["display.tone", "exposure"] },
  { key: "display.highlights", label: "Highlights keep 0 hue, 1 luminance", unit: "", range: [0, 1, 0.05] },
];

/** The value of a dotted key of nested settings. */
function setting(config, key) {
  return key.split(".").reduce((value, part) => value?.[part], config);
}

class Controls {
  /** `set`: takes keys and their values. */
  constructor(set) {
    this.set = set;
  }

  /** Shows the settings that are in force. */
  show(given) {
    this.given = given;
    const focus = document.activeElement?.id;
    const shown = CONTROLS.filter((control) => this.has(control)).map((control, i) => this.control(control, i));
    $("controls").replaceChildren(make("h2", {}, "Eye and display"), ...shown);
    if (focus && $("controls").contains($(focus))) $(focus).focus();
  }

  has({ key, only }) {
    if (only) return setting(this.given.config, only[0]) === only[1];
    return setting(this.given.config, key) !== undefined;
  }

  control(control, i) {
    const id = `control-${control.key.replaceAll(".", "-")}-${i}`;
    const stored = setting(this.given.config, control.key) ?? control.default;
    const value = control.of ? control.of(stored) : stored;
    const label = make("label", { for: id }, control.label);
    const output = make("output", { for: id }, control.range ? `${short(value)} ${control.unit}` : "");
    const input = control.choices ? this.choice(control, id, value) : this.slider(control, id, value, output);
    input.addEventListener("change", () => this.changed(control, input.value, stored));
    return make("div", { class: "control" }, label, output, input);
  }

  choice(control, id, value) {
    const options = control.choices(this.given).map((name) => make("option", name === value ? { selected: "" } : {}, name));
    return make("select", { id }, ...options);
  }

  slider(control, id, value, output) {
    const [min, max, step] = control.range;
    const input = make("input", { id, type: "range", min, max, step, value });
    input.addEventListener("input", () => (output.textContent = `${short(Number(input.value))} ${control.unit}`));
    return input;
  }

  changed(control, text, stored) {
    const value = control.range ? Number(text) : text;
    const keys = Object.fromEntries((control.also || []).map((key) => [key, null]));
    keys[control.key] = control.to ? control.to(value, stored) : value;
    if (control.key === "observer.pupil") keys["observer.pupil_mm"] = value === "fixed" ? 3 : null;
    this.set(keys);
  }
}
