// Commands of the keyboard one after another: each reads the text that the former one has changed, and its picture.

/** A command; one of them may take the steps of others that follow while it waits.
 * @typedef {{ act: () => void, pictured: boolean, add?: (step: [number, number]) => void }} Command */

export class InTurn {
  /** @param {(pictured: boolean) => boolean} isReady whether the last change is answered, and its picture is shown */
  constructor(isReady) {
    this.isReady = isReady;
    /** Commands that wait. @type {Command[]} */
    this.waiting = [];
  }

  /** Carry out a command when the former ones are done. @param {() => void} act @param {boolean} pictured whether it reads the picture */
  do(act, pictured) { this.push({ act, pictured }); }

  /** Move by a step; steps that wait are made together. @param {(way: [number, number]) => void} move @param {[number, number]} step @param {boolean} pictured */
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

  /** Carry out what can be done now. */
  proceed() {
    while (this.waiting.length && this.isReady(this.waiting[0].pictured)) this.waiting.shift()?.act();
  }

  /** Forget what waits: the connection has ended. */
  clear() { this.waiting = []; }
}
