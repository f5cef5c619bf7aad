// Counts how many 95 % intervals hold the truth: node coverage.mjs OUT
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";

const out = process.argv[2];

// subject.toml writes `CL = { "1" = 0.2933, "alpha" = 3.607 }`; parameters are called CL_0, CL_alpha, CL_q, ...
function truth() {
  const values = new Map();
  const suffix = (term) => (term === "1" ? "0" : term.replace(/_n$/, "").replace("^", ""));
  for (const line of readFileSync(join(out, "truth/subject.toml"), "utf8").split("\n")) {
    const model = line.match(/^(C[LDYlmn]) = \{(.*)\}/);
    if (!model) continue;
    for (const [, term, value] of model[2].matchAll(/"([^"]+)" = ([-+.\de]+)/g)) {
      values.set(`${model[1]}_${suffix(term)}`, Number(value));
    }
  }
  return values;
}

const expected = truth();
for (const method of ["OLS", "GTLS"]) {
  let pairs = 0;
  let covered = 0;
  const errors = new Map();
  for (const seed of readdirSync(join(out, method))) {
    const estimate = JSON.parse(readFileSync(join(out, method, seed, "estimate.json"), "utf8"));
    for (const p of estimate.parameters) {
      if (p.value === null || !expected.has(p.name)) continue;
      pairs += 1;
      if (p.low95 <= expected.get(p.name) && expected.get(p.name) <= p.high95) covered += 1;
      if (!errors.has(p.name)) errors.set(p.name, []);
      errors.get(p.name).push((p.value - expected.get(p.name)) / p.sigma);
    }
  }
  console.log(`\n${method}: ${covered} of ${pairs} (seed, parameter) pairs covered, ${((100 * covered) / pairs).toFixed(1)} %`);
  console.log("parameter      truth   mean error   rms error   [sigma]");
  for (const [name, z] of errors) {
    const mean = z.reduce((a, b) => a + b, 0) / z.length;
    const rms = Math.sqrt(z.reduce((a, b) => a + b * b, 0) / z.length);
    console.log(`${name.padEnd(12)} ${expected.get(name).toFixed(4).padStart(8)} ${mean.toFixed(2).padStart(10)} ${rms.toFixed(2).padStart(11)}`);
  }
}
