// SPDX-License-Identifier: BSD-3-Clause
// What a viewer commands over its connection, and how each command ends (web/server/foxglove.hpp).

export interface Result { name: string; good: boolean; text: string }

/** Who has control, and how the simulation goes on; `you` is the number of this viewer, `viewer` 0 for nobody. */
export interface Control { you: number; viewer: number; simulated: boolean; paused: boolean; speed: number }

/** One for each connection. */
export class Commands {
  private readonly send: (text: string) => void;
  private readonly waiting = new Map<string, (results: Result[]) => void>();
  private count = 0;

  constructor(send: (text: string) => void) { this.send = send; }

  set(values: {name: string; value: number}[]): Promise<Result[]> { return this.ask({op: 'setParameters', parameters: values}); }

  write(): Promise<Result[]> { return this.ask({op: 'writeParameters'}); }

  checks(): Promise<Result[]> { return this.ask({op: 'reportChecks'}); }

  takeControl(): Promise<Result[]> { return this.ask({op: 'takeControl'}); }

  /** Changes the simulation (flight/steering.hpp, viewer/simulation_changes.hpp have the language). */
  steer(text: string): Promise<Result[]> { return this.ask({op: 'steer', text}); }

  /** For 0.3 s, by the firmware's own rule. */
  testMotor(motor: number, value: number): Promise<Result[]> { return this.ask({op: 'testMotor', motor, value}); }

  /** gyro, accel, baro, airspeed; of a vehicle on a link also mag, rc, esc_props_off, and stop for one of these. The result has the figures
   * of its quality, or what was refused. */
  calibrate(sensor: string): Promise<Result[]> { return this.ask({op: 'calibrate', sensor}); }

  /** A message of the server that may end one. */
  answered({op, id, results}: {op?: string; id?: string; results?: Result[]}) {
    if (op !== 'parameterValues' || !id) return;
    this.waiting.get(id)?.(results ?? []);
    this.waiting.delete(id);
  }

  /** The connection is lost. */
  lost() {
    for (const end of this.waiting.values()) end([{name: '', good: false, text: 'the connection was lost; whether it was done is not known'}]);
    this.waiting.clear();
  }

  private ask(request: object): Promise<Result[]> {
    const id = String(++this.count);
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.send(JSON.stringify({...request, id}));
    });
  }
}
