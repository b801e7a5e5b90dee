// What is typed into fields of forms; prints the values, and what is wrong with others.

const [folder] = process.argv.slice(2), { entered } = await import(`${folder}/field_values.js`);
const typed = [["0.002", {}], [" 45 mm ", {}], ["pi/4", {}], ["", {}], ["1,5", {}], ["1e-3", {}], ["12", { whole: true }], ["12 mm", { whole: true }], ["1.5", { whole: true }], ["RK4", { text: true }]];
process.stdout.write(JSON.stringify(typed.map(([text, kind]) => entered(text, kind))));
