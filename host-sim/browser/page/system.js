// The system interface of the program: WASI preview 1, as far as the program uses it. Files are in
// memory. There is no network, no environment and no other program.

const OPEN = { create: 1, folder: 2, exclusive: 4, truncate: 8 };

class System extends Descriptors {
  constructor(args, root, onOutput, onError) {
    super(root, onOutput, onError);
    this.args = args.map((arg) => new TextEncoder().encode(`${arg}\0`));
  }

  // What the program imports. Faults become error codes.
  imports() {
    const calls = {};
    const names = [System, Descriptors].flatMap((of) => Object.getOwnPropertyNames(of.prototype));
    for (const name of names.filter((name) => /^[a-z]+_[a-z_]+$/.test(name))) {
      calls[name] = (...args) => {
        try {
          // Addresses above 2 GB come as negative numbers.
          const unsigned = args.map((arg) => (typeof arg === "number" ? arg >>> 0 : arg));
          return this[name](...unsigned) ?? ERRNO.ok;
        } catch (error) {
          if (error instanceof Fault) return error.errno;
          if (error instanceof Exit) throw error;
          console.error(error);
          return ERRNO.io;
        }
      };
    }
    return calls;
  }

  // --- arguments, clock, chance, end ---

  args_sizes_get(count, size) {
    this.view.setUint32(count, this.args.length, true);
    this.view.setUint32(size, this.args.reduce((sum, arg) => sum + arg.length, 0), true);
  }

  args_get(pointers, buffer) {
    this.args.forEach((arg, i) => {
      this.view.setUint32(pointers + 4 * i, buffer, true);
      this.bytes(buffer, arg.length).set(arg);
      buffer += arg.length;
    });
  }

  environ_sizes_get(count, size) {
    this.view.setUint32(count, 0, true);
    this.view.setUint32(size, 0, true);
  }

  environ_get() {}

  clock_time_get(clock, _precision, to) {
    const ms = clock === 0 ? Date.now() : performance.now();
    this.view.setBigUint64(to, BigInt(Math.round(ms * 1e6)), true);
  }

  random_get(to, length) {
    // At most 65,536 bytes at once.
    for (let done = 0; done < length; done += 65536) {
      crypto.getRandomValues(this.bytes(to + done, Math.min(65536, length - done)));
    }
  }

  sched_yield() {}

  poll_oneoff() {
    return ERRNO.nosys;
  }

  proc_exit(code) {
    throw new Exit(code);
  }

  // --- paths ---

  path_open(fd, _follow, at, length, how, _rights, _inherited, flags, to) {
    const [folder, path] = [this.folder(fd), this.text(at, length)];
    let entry = folder.find(path);
    if (entry && how & OPEN.create && how & OPEN.exclusive) fail(ERRNO.exist);
    if (!entry && how & OPEN.create) entry = this.put(folder, path, new MemoryFile());
    if (!entry) fail(ERRNO.noent);
    if (how & OPEN.folder && !(entry instanceof Folder)) fail(ERRNO.notdir);
    if (how & OPEN.truncate) (entry instanceof MemoryFile ? entry : fail(ERRNO.rofs)).resize(0);
    let number = ROOT + 1;
    while (this.open.has(number)) number += 1;
    this.open.set(number, { entry, at: 0, flags });
    this.view.setUint32(to, number, true);
  }

  put(from, path, entry) {
    const { folder, name } = from.place(path);
    if (!folder) fail(ERRNO.noent);
    if (!(folder instanceof Folder)) fail(ERRNO.notdir);
    folder.entries.set(name ?? fail(ERRNO.inval), entry);
    return entry;
  }

  take(from, path, isFolder) {
    const entry = from.find(path) ?? fail(ERRNO.noent);
    if (isFolder && !(entry instanceof Folder)) fail(ERRNO.notdir);
    if (!isFolder && entry instanceof Folder) fail(ERRNO.isdir);
    if (isFolder && entry.entries.size) fail(ERRNO.notempty);
    const { folder, name } = from.place(path);
    folder.entries.delete(name);
  }

  path_filestat_get(fd, _follow, at, length, to) {
    this.stat(this.folder(fd).find(this.text(at, length)) ?? fail(ERRNO.noent), to);
  }

  path_create_directory(fd, at, length) {
    const [folder, path] = [this.folder(fd), this.text(at, length)];
    if (folder.find(path)) fail(ERRNO.exist);
    this.put(folder, path, new Folder());
  }

  path_remove_directory(fd, at, length) {
    this.take(this.folder(fd), this.text(at, length), true);
  }

  path_unlink_file(fd, at, length) {
    this.take(this.folder(fd), this.text(at, length), false);
  }

  path_rename(fd, at, length, toFd, toAt, toLength) {
    const { folder, name } = this.folder(fd).place(this.text(at, length));
    const entry = folder?.find(name) ?? fail(ERRNO.noent);
    this.put(this.folder(toFd), this.text(toAt, toLength), entry);
    folder.entries.delete(name);
  }

  path_link() {
    return ERRNO.nosys;
  }

  path_readlink() {
    // There are no links.
    return ERRNO.inval;
  }
}
