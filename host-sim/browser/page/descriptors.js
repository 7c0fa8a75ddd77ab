// Open files by their numbers: the calls `fd_*` of the system interface.

const TYPE = { device: 2, folder: 3, file: 4 };
const APPEND = 1;
const ALL_RIGHTS = 0xffffffffffffffffn;
const ROOT = 3; // the first number behind those of the standard streams

// Text that comes in pieces, as lines.
class Lines {
  constructor(take) {
    Object.assign(this, { take, text: "", decoder: new TextDecoder() });
  }

  write(bytes) {
    const lines = (this.text + this.decoder.decode(bytes, { stream: true })).split("\n");
    this.text = lines.pop();
    lines.forEach(this.take);
  }
}

class Descriptors extends Memory {
  constructor(root, onOutput, onError) {
    super();
    this.open = new Map([
      [0, { stream: null }],
      [1, { stream: new Lines(onOutput) }],
      [2, { stream: new Lines(onError) }],
      [ROOT, { entry: root, at: 0, flags: 0 }],
    ]);
  }

  file(fd) {
    return this.open.get(fd) ?? fail(ERRNO.badf);
  }

  folder(fd) {
    const { entry } = this.file(fd);
    return entry instanceof Folder ? entry : fail(ERRNO.notdir);
  }

  fd_close(fd) {
    this.file(fd);
    this.open.delete(fd);
  }

  fd_read(fd, vectors, count, read) {
    const file = this.file(fd);
    const done = this.read(file, file.at, vectors, count);
    file.at += done;
    this.view.setUint32(read, done, true);
  }

  fd_pread(fd, vectors, count, at, read) {
    this.view.setUint32(read, this.read(this.file(fd), Number(at), vectors, count), true);
  }

  read(file, at, vectors, count) {
    if (file.entry instanceof Folder) fail(ERRNO.isdir);
    if (!file.entry) return 0;
    let done = 0;
    for (const target of this.vectors(vectors, count)) {
      const part = file.entry.read(at + done, target);
      done += part;
      if (part < target.length) break;
    }
    return done;
  }

  fd_write(fd, vectors, count, written) {
    const file = this.file(fd);
    if (file.flags & APPEND) file.at = file.entry.size;
    const done = this.write(file, file.at, vectors, count);
    file.at += done;
    this.view.setUint32(written, done, true);
  }

  fd_pwrite(fd, vectors, count, at, written) {
    this.view.setUint32(written, this.write(this.file(fd), Number(at), vectors, count), true);
  }

  write(file, at, vectors, count) {
    if (file.entry instanceof Folder) fail(ERRNO.isdir);
    let done = 0;
    for (const source of this.vectors(vectors, count)) {
      if (file.entry) file.entry.write(at + done, source) ?? fail(ERRNO.rofs);
      else file.stream?.write(source.slice());
      done += source.length;
    }
    return done;
  }

  fd_seek(fd, offset, whence, to) {
    const file = this.file(fd);
    if (!file.entry) fail(ERRNO.badf);
    const base = [0, file.at, file.entry.size][whence] ?? fail(ERRNO.inval);
    const at = base + Number(offset);
    if (at < 0) fail(ERRNO.inval);
    file.at = at;
    this.view.setBigUint64(to, BigInt(at), true);
  }

  fd_tell(fd, to) {
    this.view.setBigUint64(to, BigInt(this.file(fd).at), true);
  }

  fd_sync(fd) {
    this.file(fd);
  }

  fd_datasync(fd) {
    this.file(fd);
  }

  fd_fdstat_get(fd, to) {
    const file = this.file(fd);
    this.view.setUint8(to, Descriptors.type(file.entry));
    this.view.setUint16(to + 2, file.flags ?? 0, true);
    this.view.setBigUint64(to + 8, ALL_RIGHTS, true);
    this.view.setBigUint64(to + 16, ALL_RIGHTS, true);
  }

  fd_fdstat_set_flags(fd, flags) {
    this.file(fd).flags = flags;
  }

  fd_filestat_get(fd, to) {
    this.stat(this.file(fd).entry, to);
  }

  fd_filestat_set_size(fd, size) {
    const { entry } = this.file(fd);
    if (!(entry instanceof MemoryFile)) fail(ERRNO.inval);
    entry.resize(Number(size));
  }

  fd_filestat_set_times() {}

  fd_prestat_get(fd, to) {
    if (fd !== ROOT) fail(ERRNO.badf);
    this.view.setUint8(to, 0);
    this.view.setUint32(to + 4, 1, true);
  }

  fd_prestat_dir_name(fd, to, length) {
    if (fd !== ROOT || length < 1) fail(ERRNO.badf);
    this.bytes(to, 1).set([0x2f]);
  }

  fd_readdir(fd, buffer, length, cookie, used) {
    const entries = [...this.folder(fd).entries].slice(Number(cookie));
    let done = 0;
    for (const [i, [name, entry]] of entries.entries()) {
      const encoded = new TextEncoder().encode(name);
      const record = new Uint8Array(24 + encoded.length);
      const view = new DataView(record.buffer);
      view.setBigUint64(0, cookie + BigInt(i + 1), true);
      view.setUint32(16, encoded.length, true);
      view.setUint8(20, Descriptors.type(entry));
      record.set(encoded, 24);
      // The last record is cut off where the buffer ends.
      const part = record.subarray(0, length - done);
      this.bytes(buffer + done, part.length).set(part);
      done += part.length;
      if (done === length) break;
    }
    this.view.setUint32(used, done, true);
  }

  static type(entry) {
    if (!entry) return TYPE.device;
    return entry instanceof Folder ? TYPE.folder : TYPE.file;
  }

  stat(entry, to) {
    this.bytes(to, 64).fill(0);
    this.view.setUint8(to + 16, Descriptors.type(entry));
    this.view.setBigUint64(to + 24, 1n, true);
    this.view.setBigUint64(to + 32, BigInt(entry?.size ?? 0), true);
  }
}
