// Runs the program beside the page, so that the page stays alive. It gets the program once, and the
// files of a job. It answers with steps, with how far a file is read, and with results or a reason.

const RESULTS = ".results"; // as the program has it
const TEMPORARY = ".tmp";
const TELL_MS = 100; // at most so often

let program;

onmessage = async ({ data }) => {
  if (data.program) {
    program = WebAssembly.compile(data.program);
    return;
  }
  try {
    postMessage({ done: await run(data.files) });
  } catch (error) {
    postMessage({ failed: error.message || String(error) });
  }
};

async function run(files) {
  const root = new Folder();
  for (const name of [RESULTS, TEMPORARY]) root.entries.set(name, new Folder());
  let told = 0;
  const tell = (name) => (read, of) => {
    if (performance.now() - told < TELL_MS && read < of) return;
    told = performance.now();
    postMessage({ reading: { name, read, of } });
  };
  for (const file of files) {
    if (root.entries.has(file.name)) throw new Error(`two files have the name ${file.name}`);
    root.entries.set(file.name, new UserFile(file, tell(file.name)));
  }
  const problems = [];
  // A name that begins with a dash is no option here: the program has none.
  const system = new System(["roadgrade", ...files.map((file) => file.name)], root,
    (step) => postMessage({ step }), (problem) => problems.push(problem));
  const instance = await WebAssembly.instantiate(await program, { wasi_snapshot_preview1: system.imports() });
  system.memory = instance.exports.memory;
  const end = start(instance);
  if (end !== 0) throw new Error([...problems, ...(end === 1 ? [] : [`the program broke off (${end}); a file is probably damaged`])].join("\n"));
  return collect(root.find(RESULTS), "");
}

// Runs the program. Returns its exit code, or why it has none.
function start(instance) {
  try {
    instance.exports._start();
    return 0;
  } catch (error) {
    return error instanceof Exit ? error.code : error.message;
  }
}

// All files of a folder and its folders, by their paths.
function collect(folder, before) {
  return [...folder.entries].flatMap(([name, entry]) => {
    const path = before + name;
    return entry instanceof Folder ? collect(entry, `${path}/`) : [[path, entry.content()]];
  });
}
