// What is typed into fields of forms; prints the values, and what is wrong with others.

const [folder] = process.argv.slice(2), { accept, entered } = await import(`${folder}/field_values.js`);
/** What happens after a text was typed into a field that shows a value of the file. */
function after(text, kind, former) {
  const input = { value: text, invalid: "", validity: "", bubbles: 0, refused: [], done: [], setAttribute: (_, value) => { input.invalid = value; }, setCustomValidity: (message) => { input.validity = message; }, reportValidity: () => { input.bubbles++; }, dispatchEvent: ({ type, detail }) => input.refused.push([type, detail]) };
  accept(input, kind, former, (value) => input.done.push(value));
  return input;
}

const typed = [["0.002", {}], [" 45 mm ", {}], ["pi/4", {}], ["", {}], ["1,5", {}], ["1e-3", {}], ["12", { whole: true }], ["12 mm", { whole: true }], ["1.5", { whole: true }], ["RK4", { text: true }], ["0", { whole: true }], ["-1", { whole: true }], ["0", { whole: true, least: 0 }], ["", { whole: true }]];
const law = { text: true, required: "needs a law" };
const fields = [["", law, "2*t"], [" ", law, "2*t"], ["3*t", law, "2*t"], ["", {}, 0.3], ["1,5", {}, 0.3], ["", { required: "needed" }, ""]].map((field) => after(...field));
process.stdout.write(JSON.stringify({ values: typed.map(([text, kind]) => entered(text, kind)), fields }));
