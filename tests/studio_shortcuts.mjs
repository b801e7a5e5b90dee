// Groups of the list of keys; prints them.

const [folder] = process.argv.slice(2), { groups } = await import(`${folder}/shortcuts.js`);
process.stdout.write(JSON.stringify(groups("Ctrl+")));
