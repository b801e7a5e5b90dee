// Contacts of each two bodies of a document, and of each with a floor; prints the changes of the file, or the reasons why there are none.

const [folder, document] = process.argv.slice(2), { contact } = await import(`${folder}/new_forces.js`);
const bodies = JSON.parse(document), places = [...Object.keys(bodies).map((body) => ({ body, x: 0, y: 0 })), { body: null, x: 0, y: -1 }];
const pairs = Object.keys(bodies).flatMap((body) => places.map((place) => [{ body }, place]));
process.stdout.write(JSON.stringify(pairs.map(([first, second]) => {
  const tell = (result) => [first.body, second.body, result];
  try {
    return tell(contact(first, second, { bodies })?.operations ?? null);
  } catch (error) {
    return tell(error.message);
  }
})));
