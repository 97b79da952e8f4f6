// read_mcap.mjs FILE -- reads an MCAP file by its index, checks every checksum, prints its messages' number, times and first and last object
// as one line of JSON.
import { open } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";

const file = await open(process.argv[2]);
const { size } = await file.stat();
const readable = {
  size: async () => BigInt(size),
  read: async (offset, length) => {
    const bytes = new Uint8Array(Number(length));
    await file.read(bytes, 0, bytes.length, Number(offset));
    return bytes;
  },
};
const reader = await McapIndexedReader.Initialize({ readable });
const result = { chunks: reader.chunkIndexes.length, stated: Number(reader.statistics.messageCount), messages: 0 };
result.topics = [...reader.channelsById.values()].map((channel) => channel.topic);
result.schema = JSON.parse(new TextDecoder().decode([...reader.schemasById.values()][0].data));
for await (const message of reader.readMessages()) {
  const object = JSON.parse(new TextDecoder().decode(message.data));
  if (result.messages++ === 0) {
    result.first = object;
    result.firstTime = Number(message.logTime);
  }
  result.last = object;
  result.lastTime = Number(message.logTime);
}
await file.close();
console.log(JSON.stringify(result));
