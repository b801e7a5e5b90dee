// Values that the browser stores by name, in IndexedDB.

export class Stored {
  /** @param {string} kind of the values */
  constructor(kind) { this.kind = kind; }

  /** @returns {Promise<IDBDatabase>} */
  open() {
    return new Promise((resolve, reject) => {
      const request = indexedDB.open(`studio-${this.kind}`, 1);
      request.onupgradeneeded = () => request.result.createObjectStore(this.kind);
      request.onsuccess = () => resolve(request.result);
      request.onerror = () => reject(request.error);
    });
  }

  /** @template T @param {IDBTransactionMode} mode @param {(store: IDBObjectStore) => IDBRequest<T>} act @returns {Promise<T>} */
  async transact(mode, act) {
    const database = await this.open();
    try {
      return await new Promise((resolve, reject) => {
        const request = act(database.transaction(this.kind, mode).objectStore(this.kind));
        request.onsuccess = () => resolve(request.result);
        request.onerror = () => reject(request.error);
      });
    } finally {
      database.close();
    }
  }

  /** The stored value; null if there is none. @param {string} name @returns {Promise<unknown>} */
  async read(name) { return (await this.transact("readonly", (store) => store.get(name))) ?? null; }

  /** Store a value; null removes it. @param {string} name @param {unknown} value @returns {Promise<unknown>} */
  write(name, value) { return this.transact("readwrite", (store) => /** @type {IDBRequest<unknown>} */ (value === null ? store.delete(name) : store.put(value, name))); }
}
