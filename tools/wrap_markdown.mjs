// Lines of Markdown of at most 120 characters. Paragraphs and items of lists with a longer line are filled again; tables,
// headings, code and what cannot be broken stay as they are. Without files: all that git knows or would add.
//   node tools/wrap_markdown.mjs --check|--write [FILE...]
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { width, wrapped } from './markdown_lines.mjs';

const [mode, ...named] = process.argv.slice(2);
if (mode !== '--check' && mode !== '--write') {
  console.error('wrap_markdown: node tools/wrap_markdown.mjs --check|--write [FILE...]');
  process.exit(2);
}
const files = named.length > 0 ? named : execFileSync('git', ['ls-files', '-co', '--exclude-standard', '*.md'], { encoding: 'utf8' }).split('\n').filter(Boolean);

let wrong = 0;
for (const file of files) {
  const text = readFileSync(file, 'utf8');
  const better = wrapped(text);
  if (better === text) continue;
  if (mode === '--write') {
    writeFileSync(file, better);
    console.log(file);
    continue;
  }
  const line = text.split('\n').findIndex((was, i) => was !== better.split('\n')[i]) + 1;
  console.error(`${file}:${line}: a paragraph has lines of more than ${width} characters (node tools/wrap_markdown.mjs --write)`);
  wrong += 1;
}
process.exit(wrong > 0 ? 1 : 0);
