// Calls the `main` of a program that was compiled for wasm32-unknown-unknown, and ends as it does.
// node scripts/run-wasm.mjs PROGRAM.wasm
import { readFile } from "node:fs/promises";

const { instance } = await WebAssembly.instantiate(await readFile(process.argv[2]), {});
const status = instance.exports.main(0, 0);
console.log(`${process.argv[2].split("/").pop()}: ended with ${status}`);
process.exitCode = status;
