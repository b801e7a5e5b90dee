// Changes of a document by functions of a script; prints their operations.

const [folder, calls] = process.argv.slice(2);
process.stdout.write(JSON.stringify(await Promise.all(JSON.parse(calls).map(async ([script, name, ...given]) => (await import(`${folder}/${script}`))[name](...given)))));
