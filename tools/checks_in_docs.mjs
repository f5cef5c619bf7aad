// The tables of all checks in docs/judgement.md are what `veridyn checks` prints.
//   node tools/checks_in_docs.mjs --check|--write PROGRAM
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';

const [mode, program] = process.argv.slice(2);
if ((mode !== '--check' && mode !== '--write') || !program) {
  console.error('checks_in_docs: node tools/checks_in_docs.mjs --check|--write PROGRAM');
  process.exit(2);
}
const file = new URL('../docs/judgement.md', import.meta.url);
const text = readFileSync(file, 'utf8');
const begin = '<!-- The tables are printed by `veridyn checks`; a test compares. -->\n';
const end = '<!-- End of the tables. -->\n';
const first = text.indexOf(begin);
const last = text.indexOf(end);
if (first < 0 || last < first) {
  console.error('docs/judgement.md: the marks around the tables of checks are missing');
  process.exit(1);
}
const tables = execFileSync(program, ['checks'], { encoding: 'utf8' });
const wanted = `${text.slice(0, first)}${begin}\n${tables}${text.slice(last)}`;
if (wanted === text) process.exit(0);
if (mode === '--write') {
  writeFileSync(file, wanted);
} else {
  console.error('docs/judgement.md: the tables are not those of `veridyn checks`; node tools/checks_in_docs.mjs --write PROGRAM');
  process.exit(1);
}
