// The API reference, build/docs/html: Doxygen over the headers of the library, with a page for each module and sub-module, and the
// way through a module at its face (veridyn/aircraft.hpp). The headers of bench/reproduction are checked like them and have no
// page, since they are not installed. The sentence of a folder comes from the lists of docs/architecture.md, that of a header
// from its own comments, so nothing is said twice.
// Fails where a folder has no sentence or a sentence no folder, where Doxygen warns, where a type or a free function of the
// modules in `complete` has no comment (but `to_string`, whose name says all), and where a document names a file or links
// to a heading that does not exist.
//   node tools/docs.mjs [OUTPUT_FOLDER]
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';

// Modules whose types and free functions all have comments; the others are counted. Add a module when it is done.
const complete = ['core', 'numerics', 'estimation', 'io', 'recording', 'aircraft', 'vehicle', 'muscle', 'cueing', 'report', 'reproduction'];

const output = process.argv[2] ?? 'build/docs';
if (output.startsWith('-')) {
  console.error('docs: there are no options: node tools/docs.mjs [OUTPUT_FOLDER]');
  process.exit(2);
}
const architecture = 'docs/architecture.md';

const files = execFileSync('git', ['ls-files', '-co', '--exclude-standard', 'veridyn', 'bench/reproduction'], { encoding: 'utf8' }).split('\n');
const headers = files.filter((file) => file.endsWith('.hpp')).sort();
/// The face of a module, veridyn/aircraft.hpp: what its users include.
const isFace = (header) => dirname(header) === 'veridyn';
const folders = new Set(headers.filter((header) => !isFace(header)).map((header) => dirname(header)));
for (const folder of [...folders]) {
  if (dirname(folder) !== 'veridyn') folders.add(dirname(folder));
}

const installed = (path) => path.startsWith('veridyn/');

/// The sentences of the folders: items "- `veridyn/x/y`: sentence" of the lists of modules, over one or more lines.
function readSentences() {
  const sentences = new Map();
  for (const [, folder, text] of readFileSync(architecture, 'utf8').matchAll(/^- `(veridyn(?:\/[a-z0-9_]+)+|bench\/reproduction(?:\/[a-z]+)?)`: (.+(?:\n  \S.*)*)/gm)) {
    sentences.set(folder, text.replace(/\n\s*/g, ' '));
  }
  return sentences;
}

/// First sentence of a comment; abbreviations and ranges ("0 .. 1") do not end one.
function firstSentence(text) {
  const end = text.search(/[^.]\.(\s+[A-Z`(]|$)/);
  return (end < 0 ? text.replace(/[.:]$/, '') : text.slice(0, end + 1)).trim() + '.';
}

/// What a header is for: the comment of the type or function that it is named after, else its first one.
function headerSentence(header) {
  const wanted = basename(header, '.hpp').replaceAll('_', '');
  let comment = [];
  let first = null;
  for (const line of readFileSync(header, 'utf8').split('\n')) {
    const text = line.match(/^\/\/\/ ?(.*)$/);
    if (text) {
      if (!(comment.length > 0 && comment.at(-1) === '')) comment.push(text[1].trim());
      continue;
    }
    if (comment.length > 0) {
      if (/^template/.test(line)) continue;
      const blank = comment.indexOf('');
      const sentence = firstSentence(comment.slice(0, blank < 0 ? undefined : blank).join(' '));
      first ??= sentence;
      const name = line.match(/^(?:struct|class|enum class) (\w+)/)?.[1] ?? line.match(/(\w+)\(/)?.[1];
      if (name?.replaceAll('_', '').toLowerCase() === wanted) return sentence;
      comment = [];
    }
  }
  return first;
}

/// The comment at the head of a face after its first sentence: the way through its module.
function wayThrough(face) {
  const comment = readFileSync(face, 'utf8').split('\n').filter((line) => line.startsWith('///')).map((line) => line.slice(4));
  return comment.slice(comment.indexOf('')).map((line) => ` *  ${plain(line)}\n`).join('');
}

/// Links of the documents and paths between backquotes that lead nowhere.
function deadReferences() {
  const dead = [];
  const anchors = (document) =>
    [...readFileSync(document, 'utf8').matchAll(/^#+ (.*)$/gm)].map((heading) =>
      heading[1].toLowerCase().replace(/[^\p{L}\p{N} _-]/gu, '').replaceAll(' ', '-'),
    );
  const documents = execFileSync('git', ['ls-files', '-co', '--exclude-standard', '*.md'], { encoding: 'utf8' }).trim().split('\n');
  for (const document of documents.filter((file) => existsSync(file) && file !== 'CHANGELOG.md')) {
    const text = readFileSync(document, 'utf8').replace(/^```[^]*?^```/gm, '');
    for (const [, target] of text.matchAll(/\]\(([^)\s]+)\)/g)) {
      if (/^[a-z]+:/.test(target)) continue;
      const [path, anchor] = target.split('#');
      const file = path === '' ? document : join(dirname(document), path);
      if (!existsSync(file)) dead.push(`${document}: links to ${target}, which does not exist`);
      else if (anchor && !anchors(file).includes(anchor)) dead.push(`${document}: links to ${target}; there is no such heading`);
    }
    for (const [, path] of text.matchAll(/`((?:veridyn|apps|tests|bench|examples|tools|cmake|docs|fuzz)\/[\w/.-]+)`/g)) {
      if (!existsSync(path) && !/\/[xyz][/._]/.test(path)) dead.push(`${document}: names ${path}, which does not exist`);
    }
  }
  return dead;
}

const problems = deadReferences();
const sentences = readSentences();
for (const folder of folders) {
  if (!sentences.has(folder)) problems.push(`${architecture}: does not describe the folder ${folder}`);
}
for (const folder of sentences.keys()) {
  if (!folders.has(folder)) problems.push(`${architecture}: there is no folder ${folder} with headers`);
}

// Commands of Doxygen in a sentence that is not meant for it.
const plain = (text) => text.replaceAll('\\', '\\\\').replaceAll('@', '\\@').replaceAll('#', '\\#').replaceAll('/*', '/ *').replaceAll('*/', '* /').replace(/<(?=[a-zA-Z/])/g, '\\<');
let pages = '';
for (const header of headers) {
  const sentence = headerSentence(header);
  const more = isFace(header) ? ` *\n${wayThrough(header)}` : '';
  if (installed(header)) pages += `/** \\file ${header}\n *  \\brief ${plain(sentence ?? '')}\n${more} */\n`;
  if (!sentence) problems.push(`${header}: has no comment that says what it is`);
}
for (const folder of [...folders].filter(installed).sort()) {
  const inside = headers.filter((header) => dirname(header) === folder);
  const sentence = sentences.get(folder) ?? '';
  const id = folder.replaceAll('/', '_');
  pages += `/** \\dir ${folder}\n *  \\brief ${plain(sentence)}\n */\n`;
  pages += `/** \\page ${id} ${folder.slice('veridyn/'.length)}\n *  ${plain(sentence)}\n *\n`;
  if (existsSync(`${folder}.hpp`)) pages += ` *  Its users include \\ref ${folder}.hpp.\n *\n`;
  for (const header of inside) pages += ` *  - \\ref ${header} "${basename(header)}": ${plain(headerSentence(header) ?? '')}\n`;
  for (const below of [...folders].sort()) {
    if (dirname(below) === folder) pages += ` *  - \\subpage ${below.replaceAll('/', '_')} "${basename(below)}": ${plain(sentences.get(below) ?? '')}\n`;
  }
  pages += ' */\n';
}
pages += '/** \\mainpage\n *  Reference of the library, made from its headers. Each module depends on those before it only.\n *\n';
for (const folder of sentences.keys()) {
  if (dirname(folder) === 'veridyn' && folders.has(folder))
    pages += ` *  - \\subpage ${folder.replaceAll('/', '_')} "${basename(folder)}": ${plain(sentences.get(folder))}\n`;
}
pages += ' */\n';
for (const name of ['', ...[...folders].filter((f) => dirname(f) === 'veridyn').map((f) => `::${basename(f)}`)]) {
  const sentence = name === '' ? 'The library.' : (sentences.get(`veridyn/${name.slice(2)}`) ?? '');
  pages += `/** \\namespace veridyn${name}\n *  \\brief ${plain(sentence)}\n */\n`;
}

mkdirSync(output, { recursive: true });
writeFileSync(join(output, 'modules.dox'), pages);

/// Runs Doxygen over `input` with docs/Doxyfile and these settings on top; returns its warnings.
function doxygen(input, settings) {
  const configuration = readFileSync('docs/Doxyfile', 'utf8') + `\nOUTPUT_DIRECTORY = ${output}\nINPUT = ${input} ${output}/modules.dox\n` + settings;
  const run = spawnSync('doxygen', ['-'], { input: configuration, encoding: 'utf8', maxBuffer: 1 << 28 });
  if (run.error) throw new Error(`doxygen cannot be run (${run.error.message}); \`make setup\` installs it`);
  const warnings = run.stderr.split('\n').filter((line) => line.trim() !== '');
  if (run.status !== 0 && warnings.length === 0) warnings.push(`doxygen ended with ${run.status}`);
  return [...new Set(warnings.map((line) => line.replace(`${process.cwd()}/`, '')))];
}

const version = readFileSync('CMakeLists.txt', 'utf8').match(/VERSION (\d+\.\d+\.\d+)/)?.[1] ?? '';
problems.push(...doxygen('veridyn', `PROJECT_NUMBER = ${version}\nEXTRACT_ALL = YES\nWARN_AS_ERROR = FAIL_ON_WARNINGS\n`));
const undocumented = doxygen('veridyn bench/reproduction', 'GENERATE_HTML = NO\nEXTRACT_ALL = NO\nWARN_IF_UNDOCUMENTED = YES\n').filter(
  (line) => !/Member to_string\(/.test(line) && (/Compound \S+.* is not documented/.test(line) || /\((function|variable|typedef|enumeration)\) of (namespace|file) .* is not documented/.test(line)),
);
const inModules = new Map();
for (const line of undocumented) {
  const module = line.match(/^(?:veridyn|bench)\/(\w+)\//)?.[1];
  if (complete.includes(module)) problems.push(line);
  else inModules.set(module, (inModules.get(module) ?? 0) + 1);
}
for (const [module, count] of inModules) console.error(`docs: ${count} types and functions of ${module} have no comment yet`);
for (const problem of problems) console.error(`docs: ${problem}`);
console.error(`docs: ${headers.length} headers in ${folders.size} folders, ${problems.length} problems; ${join(output, 'html/index.html')}`);
process.exit(problems.length === 0 ? 0 : 1);
