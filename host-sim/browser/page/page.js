// The page: takes files, has a worker do the work, and shows how far it is.
(() => {
  const byId = (id) => document.getElementById(id);
  const worker_url = URL.createObjectURL(new Blob([byId("worker").textContent], { type: "text/javascript" }));
  const program = unpack(byId("program").textContent);
  let worker, ready, clock;

  async function unpack(text) {
    const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
  }

  // The state is on the page, for those who watch it: waiting, working, done or failed.
  function enter(state) {
    document.body.dataset.state = state;
    byId("work").hidden = state !== "working";
    byId("files").disabled = state === "working";
    byId("drop").classList.toggle("busy", state === "working");
    if (state !== "working") clearInterval(clock);
  }

  function begin() {
    worker?.terminate();
    const next = (worker = new Worker(worker_url));
    worker.onmessage = ({ data }) => take(data);
    worker.onerror = (event) => fail(event.message);
    ready = program.then((bytes) => {
      next.postMessage({ program: bytes });
      return next;
    });
    ready.catch((error) => show(`this browser cannot run the program (${error.message}); expected one of 2023 or later`));
  }

  function work(files) {
    if (!files.length || document.body.dataset.state === "working") return;
    const started = performance.now();
    const seconds = () => `${((performance.now() - started) / 1000).toFixed(0)} s`;
    enter("working");
    for (const id of ["problem", "results"]) byId(id).hidden = true;
    byId("step").textContent = "reading the logs";
    byId("reading").textContent = byId("elapsed").textContent = "";
    byId("bar").removeAttribute("value");
    clock = setInterval(() => (byId("elapsed").textContent = seconds()), 250);
    const chosen = [...files];
    ready.then((to) => to.postMessage({ files: chosen }));
  }

  function take({ step, reading, done, failed }) {
    if (step) byId("step").textContent = step;
    if (reading) showReading(reading);
    if (failed) fail(failed);
    if (done) {
      enter("done");
      showResults(done);
    }
  }

  function showReading({ name, read, of }) {
    const mb = (bytes) => (bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0);
    byId("reading").textContent = `${name}: ${mb(read)} of ${mb(of)} MB`;
    byId("bar").value = read / of;
  }

  function show(problem) {
    enter("failed");
    byId("problem").textContent = problem;
    byId("problem").hidden = false;
  }

  function fail(problem) {
    show(problem);
    // A program that broke off is not used again.
    begin();
  }

  function listen() {
    const drop = byId("drop");
    const over = (is_over) => (event) => {
      event.preventDefault();
      drop.classList.toggle("over", is_over && document.body.dataset.state !== "working");
    };
    // Anywhere on the page: a file that misses the box would replace the page.
    document.addEventListener("dragover", over(true));
    document.addEventListener("dragleave", over(false));
    document.addEventListener("drop", (event) => {
      over(false)(event);
      work(event.dataTransfer.files);
    });
    byId("files").addEventListener("change", (event) => {
      work(event.target.files);
      // So that the same file can be chosen again.
      event.target.value = "";
    });
    byId("stop").addEventListener("click", () => {
      enter("waiting");
      begin();
    });
  }

  listen();
  enter("waiting");
  begin();
})();
