// What the docs show of the program's own tables is what the program prints: each stretch between
//   <!-- Printed by `veridyn ARGUMENTS`; a test compares. -->   and   <!-- End of what is printed. -->
//   node tools/printed_in_docs.mjs --check|--write PROGRAM
import { execFileSync } from 'node:child_process';
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { wrapped } from './markdown_lines.mjs';

const [mode, program] = process.argv.slice(2);
if ((mode !== '--check' && mode !== '--write') || !program) {
  console.error('printed_in_docs: node tools/printed_in_docs.mjs --check|--write PROGRAM');
  process.exit(2);
}
const docs = new URL('../docs/', import.meta.url);
const printed = /(<!-- Printed by `veridyn ([^`]+)`; a test compares\. -->\n)[^]*?(<!-- End of what is printed\. -->\n)/g;
const begins = /<!-- Printed by /g;
let stretches = 0;
let wrong = 0;
for (const name of readdirSync(docs).filter((file) => file.endsWith('.md'))) {
  const file = new URL(name, docs);
  const text = readFileSync(file, 'utf8');
  let here = 0;
  const wanted = text.replace(printed, (_, begin, command, end) => {
    here += 1;
    return `${begin}\n${wrapped(execFileSync(program, command.split(' '), { encoding: 'utf8' }))}\n${end}`;
  });
  if (here !== (text.match(begins) ?? []).length) {
    console.error(`docs/${name}: a stretch of printed tables has no end`);
    wrong += 1;
  }
  stretches += here;
  if (wanted === text) continue;
  if (mode === '--write') {
    writeFileSync(file, wanted);
  } else {
    console.error(`docs/${name}: a table is not what the program prints; node tools/printed_in_docs.mjs --write PROGRAM`);
    wrong += 1;
  }
}
if (stretches === 0) {
  console.error('docs: no stretch of printed tables was found');
  wrong += 1;
}
process.exit(wrong === 0 ? 0 : 1);
