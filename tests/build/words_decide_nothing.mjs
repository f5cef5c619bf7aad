// Nothing is decided by what a row says: its sentence, advice and name are printed, never compared or searched.
//   node words_decide_nothing.mjs ROOT
import { readdirSync, readFileSync } from 'node:fs';
import { join, relative } from 'node:path';

const root = process.argv[2];
const said = /\b(says|advice_of|name_of)\(\s*\*?(row|evidence|e|reason|r)\b[^)]*\)|\bdecided_by\b(?!\.(size|empty|push_back|begin|end|insert|clear)\()|\.reason\b|\bverdict\.headline\b/;
const decides = /==\s*"|!=\s*"|"\s*==|"\s*!=|\.(find|starts_with|ends_with|compare|rfind)\(/;
// A row whose sentence names what it is about is not printed with it once more.
const allowed = new Set(['veridyn/estimation/judgement/wording.cpp']);
const findings = [];
function search(folder) {
  for (const entry of readdirSync(folder, { withFileTypes: true })) {
    const path = join(folder, entry.name);
    if (entry.isDirectory()) search(path);
    else if (/\.(cpp|hpp)$/.test(entry.name) && !allowed.has(relative(root, path))) {
      readFileSync(path, 'utf8').split('\n').forEach((line, i) => {
        if (said.test(line) && decides.test(line)) findings.push(`${relative(root, path)}:${i + 1}: ${line.trim()}`);
      });
    }
  }
}
for (const folder of ['veridyn', 'apps']) search(join(root, folder));
if (findings.length > 0) {
  console.error(`decided by words:\n${findings.join('\n')}`);
  process.exit(1);
}
