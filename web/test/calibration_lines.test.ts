// SPDX-License-Identifier: BSD-3-Clause
// Lines of a calibration out of the events of a flight.
import assert from 'node:assert/strict';
import {test} from 'node:test';
import {calibrationLines} from '../src/data/calibration_lines.ts';
import {Flight} from '../src/data/flight.ts';

test('are those of the newest calibration, and stay while it is stopped', () => {
  const flight = new Flight('made');
  const says = (text: string, source = 'viewer') => flight.events.push({t: 1, tone: 'note', source, text});
  assert.deepEqual(calibrationLines(flight), []);
  says('viewer 1 calibrates mag');
  says('viewer 1 calibration: nose down');
  says('viewer 1 calibration: not by a viewer', 'fcu');
  assert.deepEqual(calibrationLines(flight), ['nose down']);
  says('viewer 1 calibrates stop');
  says('viewer 1 calibration: stopped: former values put back');
  assert.deepEqual(calibrationLines(flight), ['nose down', 'stopped: former values put back']);
  says('viewer 2 calibrates gyro');
  assert.deepEqual(calibrationLines(flight), []);
});
