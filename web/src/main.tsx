// SPDX-License-Identifier: BSD-3-Clause
import './locale.ts';
import 'uplot/dist/uPlot.min.css';
import './style.css';
import {render} from 'preact';
import {openFirst} from './open.ts';
import {App} from './views/app.tsx';

render(<App/>, document.getElementById('app')!);
void openFirst();
