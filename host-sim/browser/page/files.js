// Files and folders in memory, and the user's files, which are read piece by piece where they lie.

const BLOCK = 4 << 20; // bytes that are read of a user's file at once
const KEPT = 256 << 20; // bytes of a user's file that stay in memory: it is read three times

class MemoryFile {
  constructor() {
    this.bytes = new Uint8Array(0);
    this.size = 0;
  }

  read(at, target) {
    const part = this.bytes.subarray(at, Math.max(at, Math.min(this.size, at + target.length)));
    target.set(part);
    return part.length;
  }

  write(at, source) {
    this.resize(Math.max(this.size, at + source.length));
    this.bytes.set(source, at);
    return source.length;
  }

  resize(size) {
    if (size > this.bytes.length) {
      const grown = new Uint8Array(Math.max(size, 2 * this.bytes.length, 4096));
      grown.set(this.bytes.subarray(0, this.size));
      this.bytes = grown;
    }
    this.bytes.fill(0, size, this.size);
    this.size = size;
  }

  content() {
    return this.bytes.slice(0, this.size);
  }
}

// A file of the user. `onRead` gets the number of bytes up to which it is read.
class UserFile {
  constructor(file, onRead) {
    Object.assign(this, { file, onRead, size: file.size, block: new Uint8Array(0), start: 0 });
    this.blocks = new Map();
  }

  read(at, target) {
    let done = 0;
    while (done < target.length && at + done < this.size) {
      this.load(at + done);
      const from = at + done - this.start;
      const part = this.block.subarray(from, from + target.length - done);
      target.set(part, done);
      done += part.length;
    }
    return done;
  }

  load(at) {
    if (at >= this.start && at < this.start + this.block.length) return;
    this.start = at - (at % BLOCK);
    this.block = this.blocks.get(this.start) ?? this.fetch();
    // The file may have become shorter since it was chosen.
    if (at >= this.start + this.block.length) throw new Error("the file ends too early");
    this.onRead(this.start + this.block.length, this.size);
  }

  fetch() {
    const piece = this.file.slice(this.start, this.start + BLOCK);
    const block = new Uint8Array(new FileReaderSync().readAsArrayBuffer(piece));
    if (this.start + BLOCK <= KEPT) this.blocks.set(this.start, block);
    return block;
  }

  write() {
    return null;
  }
}

class Folder {
  constructor() {
    this.entries = new Map();
    this.size = 0;
  }

  // The entry at a path, or undefined.
  find(path) {
    let found = this;
    for (const name of Folder.names(path)) {
      found = found instanceof Folder ? found.entries.get(name) : undefined;
    }
    return found;
  }

  // The folder that has the last part of a path, and that part.
  place(path) {
    const names = Folder.names(path);
    const name = names.pop();
    return { folder: this.find(names.join("/")), name };
  }

  static names(path) {
    return path.split("/").filter((name) => name && name !== ".");
  }
}
