// What was computed, in words: warnings, plan, check, constants, settings and what is not modelled.
function heading(text) {
  return make("h2", {}, text);
}

function listed(head, rows, wide) {
  const cells = (tag, row) => make("tr", {}, ...row.map((cell) => make(tag, {}, cell)));
  return make("table", wide ? { class: "wide" } : {}, make("thead", {}, cells("th", head)), make("tbody", {}, ...rows.map((row) => cells("td", row))));
}

function percent(bound) {
  return bound === null || bound === undefined ? "no bound" : `${short(100 * bound)} %`;
}

/** Leaves of nested settings, by dotted keys. */
function flat(value, key = "") {
  const inner = value && typeof value === "object" && !Array.isArray(value);
  return inner ? Object.entries(value).flatMap(([name, v]) => flat(v, key ? `${key}.${name}` : name)) : [[key, value]];
}

function written(value) {
  if (Array.isArray(value)) return value.length ? value.map(written).join(", ") : "none";
  if (typeof value === "number") return String(Number(value.toPrecision(6)));
  return typeof value === "string" ? value : JSON.stringify(value);
}

function planInWords(plan) {
  if (!plan || !plan.terms) return [];
  const chosen = plan.terms.filter((term) => term.chosen !== false);
  const rest = plan.terms.filter((term) => term.chosen === false);
  const row = (term) => [term.what, percent(term.bound), term.why || ""];
  return [
    heading("Plan"),
    make("p", {}, `The model is "${plan.model}". What was left out may change pigment and catch by at most ${percent(plan.bound_total)}; ${percent(plan.budget)} was allowed.`),
    listed(["Chosen", "Largest error", "Because"], chosen.map(row), true),
    ...(rest.length ? [make("p", {}, "Not chosen:"), listed(["What", "It would have erred by", "Because"], rest.map(row), true)] : []),
  ];
}

function checkInWords(check) {
  if (!check) return [];
  const told = check.samples
    ? `${check.samples} places were followed at the full model beside the run: pigment differed by at most ${percent(check.max_error_p)}, the catch by at most ${percent(check.max_error_catch)}.`
    : "Nothing was compared: the model that was asked for is not meant to be true.";
  return [heading("Check"), make("p", {}, told)];
}

function constantsInWords(constants) {
  if (!constants) return [];
  const rows = flat(constants).map(([key, value]) => [key.replaceAll("_", " "), written(value)]);
  return [heading("Constants and their sources"), listed(["Constant", "Value"], rows)];
}

/** What became of one probe. */
function resultOf(result) {
  const triple = (values) => values.map(short).join(", ");
  const recoveries = [50, 90, 95].map((share) => result[`recovery_${share}_s`]);
  return [
    ["Probe", result.probe],
    ["Pigment left at the end, L, M, S", triple(result.p)],
    ["Most bleached, L, M, S", triple(result.greatest_bleached)],
    ["Most bleached at, s", triple(result.greatest_bleached_at_s)],
    ["Luminance of the percept at the end", `${short(result.Y)} cd/m\u00b2`],
    ["Seconds in the dark until L, M and S are back at 50, 90, 95 %", triple(recoveries)],
  ];
}

function resultsInWords(results) {
  if (!results) return [];
  return [heading("Results"), listed(["Result", "Value"], results.flatMap(resultOf))];
}

function warningsInWords(warnings = []) {
  const one = (warning) => make("p", { class: "warning" }, warning);
  return warnings.length ? [heading("Warnings"), ...warnings.map(one)] : [];
}

/** What no setting can switch on, and what this run left off. */
function notModelled(config = {}) {
  const optics = config.optics && config.optics.psf && config.optics.psf !== "none";
  const items = [
    ...(optics ? [] : ["Glare: light scattered in the eye itself. Edges are sharper than a real eye's, and no veil lies around the light."]),
    "Adaptation behind the pigment: what nerves and brain make of the cones' catch. Real after-images fade and change sooner.",
    "Rods, and vision by them in the dark.",
    "Blinks and the small movements of an eye that tries to hold still; they soften the edges of after-images.",
    "Damage. Never stare at the real sun.",
  ];
  return [heading("Not modelled"), make("ul", {}, ...items.map((item) => make("li", {}, item)))];
}

function settingsInWords(config) {
  if (!config) return [];
  const rows = flat(config).map(([key, value]) => [key, written(value)]);
  return [make("details", {}, make("summary", {}, "Settings"), listed(["Key", "Value"], rows))];
}

/** Everything that a report says beside its pictures and curves. */
function inWords(report) {
  return [
    ...warningsInWords(report.warnings),
    ...notModelled(report.config),
    ...resultsInWords(report.results),
    ...planInWords(report.plan),
    ...checkInWords(report.check),
    ...constantsInWords(report.constants),
    ...settingsInWords(report.config),
    make("p", { class: "fine" }, `sungaze ${report.version || ""}`),
  ];
}
