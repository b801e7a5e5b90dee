// Queue of the commands of the mouse and the keyboard: each waits until the change of the one before is answered and its picture is shown.

/** A command, and whether it reads the picture; a waiting movement adds the steps of those that follow.
 * @typedef {{ act: () => void, pictured: boolean, add?: (step: [number, number]) => void }} Command */

export class CommandQueue {
  /** @param {(pictured: boolean) => boolean} isReady whether the last change is answered, and its picture is shown */
  constructor(isReady) {
    this.isReady = isReady;
    /** Commands that wait. @type {Command[]} */
    this.waiting = [];
  }

  /** Execute a command after those before. @param {() => void} act @param {boolean} pictured whether it reads the picture */
  do(act, pictured) { this.push({ act, pictured }); }

  /** Move by a step; waiting steps are executed as one. @param {(way: [number, number]) => void} move @param {[number, number]} step @param {boolean} pictured */
  step(move, step, pictured) {
    const last = this.waiting.at(-1);
    if (last?.add) return last.add(step);
    let [x, y] = step;
    this.push({ act: () => move([x, y]), pictured, add: ([dx, dy]) => { [x, y] = [x + dx, y + dy]; } });
  }

  /** @param {Command} command */
  push(command) {
    this.waiting.push(command);
    this.proceed();
  }

  /** Execute the commands that need not wait. */
  proceed() {
    while (this.waiting.length && this.isReady(this.waiting[0].pictured)) this.waiting.shift()?.act();
  }

  /** Remove all commands; returns whether there were some. */
  clear() { return this.waiting.splice(0).length > 0; }
}
