// Zeros of a sampled cosine, and of two samples alone.

const [folder] = process.argv.slice(2), { zeroAfter } = await import(`${folder}/plane_kinematics.js`);
const cosine = Array.from({ length: 120 }, (_, k) => Math.cos(k / 12)), zeros = [];
for (let k = 0; k < 119; k++) if (Math.sign(cosine[k]) !== Math.sign(cosine[k + 1])) zeros.push(k + zeroAfter(cosine, k));
process.stdout.write(JSON.stringify({ zeros: zeros.map((k) => k / 12), line: zeroAfter([3, -1], 0) }));
