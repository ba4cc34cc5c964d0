// SPDX-License-Identifier: BSD-3-Clause
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {parseSchema} from '../src/data/ros_schema.ts';

const TWO = `# comment
std_msgs/Header header
uint8 GOOD=1     # a constant
float32[3] position   # [m]
string<=10 name
float64[<=4] bounded
bool[] flags
Inner[] inner
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: some_msgs/Inner
char letter
`;

test('fields are found with their types, arrays and the messages they use', () => {
  const {name, fields} = parseSchema('some_msgs/msg/Outer', TWO);
  assert.equal(name, 'some_msgs/Outer');
  assert.deepEqual(fields.map(({name, count}) => [name, count]), [['header', undefined], ['position', 3], ['name', undefined],
    ['bounded', 'sequence'], ['flags', 'sequence'], ['inner', 'sequence']]);
  const [header, , , , , inner] = fields;
  assert.deepEqual(header!.type, {name: 'std_msgs/Header', fields: [
    {name: 'stamp', type: {name: 'builtin_interfaces/Time', fields: [{name: 'sec', type: 'int32'}, {name: 'nanosec', type: 'uint32'}]}},
    {name: 'frame_id', type: 'string'}]});
  assert.deepEqual(inner!.type, {name: 'some_msgs/Inner', fields: [{name: 'letter', type: 'uint8'}]});
});

test('what cannot be understood is said', () => {
  assert.throws(() => parseSchema('a/B', 'Missing x'), /a\/B: no definition of Missing/);
  assert.throws(() => parseSchema('a/B', 'float32[ x'), /'float32\[ x' is no field/);
  assert.throws(() => parseSchema('a/B', 'a/B again\n===\nMSG: a/B\na/B again'), /nested in more than 16/);
  assert.throws(() => parseSchema('a/B', 'int8 x\n===\nint8 y'), /no line 'MSG/);
});
