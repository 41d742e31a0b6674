var Ze,x,nn,Xe,ce,Qt,sn,on,rn,kt,wt,xt,Ms,Oe={},an=[],Cs=/acit|ex(?:s|g|n|p|$)|rph|grid|ows|mnc|ntw|ine[ch]|zoo|^ord|itera/i,Qe=Array.isArray;function te(e,t){for(var n in t)e[n]=t[n];return e}function St(e){e&&e.parentNode&&e.parentNode.removeChild(e)}function Ye(e,t,n){var s,o,i,r={};for(i in t)i=="key"?s=t[i]:i=="ref"?o=t[i]:r[i]=t[i];if(arguments.length>2&&(r.children=arguments.length>3?Ze.call(arguments,2):n),typeof e=="function"&&e.defaultProps!=null)for(i in e.defaultProps)r[i]===void 0&&(r[i]=e.defaultProps[i]);return Ke(e,r,s,o,null)}function Ke(e,t,n,s,o){var i={type:e,props:t,key:n,ref:s,__k:null,__:null,__b:0,__e:null,__c:null,constructor:void 0,__v:o??++nn,__i:-1,__u:0};return o==null&&x.vnode!=null&&x.vnode(i),i}function et(e){return e.children}function ue(e,t){this.props=e,this.context=t}function be(e,t){if(t==null)return e.__?be(e.__,e.__i+1):null;for(var n;t<e.__k.length;t++)if((n=e.__k[t])!=null&&n.__e!=null)return n.__e;return typeof e.type=="function"?be(e):null}function ln(e){var t,n;if((e=e.__)!=null&&e.__c!=null){for(e.__e=e.__c.base=null,t=0;t<e.__k.length;t++)if((n=e.__k[t])!=null&&n.__e!=null){e.__e=e.__c.base=n.__e;break}return ln(e)}}function Yt(e){(!e.__d&&(e.__d=!0)&&ce.push(e)&&!Je.__r++||Qt!=x.debounceRendering)&&((Qt=x.debounceRendering)||sn)(Je)}function Je(){for(var e,t,n,s,o,i,r,c=1;ce.length;)ce.length>c&&ce.sort(on),e=ce.shift(),c=ce.length,e.__d&&(n=void 0,o=(s=(t=e).__v).__e,i=[],r=[],t.__P&&((n=te({},s)).__v=s.__v+1,x.vnode&&x.vnode(n),Mt(t.__P,n,s,t.__n,t.__P.namespaceURI,32&s.__u?[o]:null,i,o??be(s),!!(32&s.__u),r),n.__v=s.__v,n.__.__k[n.__i]=n,dn(i,n,r),n.__e!=o&&ln(n)));Je.__r=0}function cn(e,t,n,s,o,i,r,c,u,l,p){var d,f,h,v,m,$,b=s&&s.__k||an,y=t.length;for(u=Ts(n,t,b,u,y),d=0;d<y;d++)(h=n.__k[d])!=null&&(f=h.__i==-1?Oe:b[h.__i]||Oe,h.__i=d,$=Mt(e,h,f,o,i,r,c,u,l,p),v=h.__e,h.ref&&f.ref!=h.ref&&(f.ref&&Ct(f.ref,null,h),p.push(h.ref,h.__c||v,h)),m==null&&v!=null&&(m=v),4&h.__u||f.__k===h.__k?u=un(h,u,e):typeof h.type=="function"&&$!==void 0?u=$:v&&(u=v.nextSibling),h.__u&=-7);return n.__e=m,u}function Ts(e,t,n,s,o){var i,r,c,u,l,p=n.length,d=p,f=0;for(e.__k=new Array(o),i=0;i<o;i++)(r=t[i])!=null&&typeof r!="boolean"&&typeof r!="function"?(u=i+f,(r=e.__k[i]=typeof r=="string"||typeof r=="number"||typeof r=="bigint"||r.constructor==String?Ke(null,r,null,null,null):Qe(r)?Ke(et,{children:r},null,null,null):r.constructor==null&&r.__b>0?Ke(r.type,r.props,r.key,r.ref?r.ref:null,r.__v):r).__=e,r.__b=e.__b+1,c=null,(l=r.__i=Es(r,n,u,d))!=-1&&(d--,(c=n[l])&&(c.__u|=2)),c==null||c.__v==null?(l==-1&&(o>p?f--:o<p&&f++),typeof r.type!="function"&&(r.__u|=4)):l!=u&&(l==u-1?f--:l==u+1?f++:(l>u?f--:f++,r.__u|=4))):e.__k[i]=null;if(d)for(i=0;i<p;i++)(c=n[i])!=null&&(2&c.__u)==0&&(c.__e==s&&(s=be(c)),fn(c,c));return s}function un(e,t,n){var s,o;if(typeof e.type=="function"){for(s=e.__k,o=0;s&&o<s.length;o++)s[o]&&(s[o].__=e,t=un(s[o],t,n));return t}e.__e!=t&&(t&&e.type&&!n.contains(t)&&(t=be(e)),n.insertBefore(e.__e,t||null),t=e.__e);do t=t&&t.nextSibling;while(t!=null&&t.nodeType==8);return t}function Es(e,t,n,s){var o,i,r=e.key,c=e.type,u=t[n];if(u===null&&e.key==null||u&&r==u.key&&c==u.type&&(2&u.__u)==0)return n;if(s>(u!=null&&(2&u.__u)==0?1:0))for(o=n-1,i=n+1;o>=0||i<t.length;){if(o>=0){if((u=t[o])&&(2&u.__u)==0&&r==u.key&&c==u.type)return o;o--}if(i<t.length){if((u=t[i])&&(2&u.__u)==0&&r==u.key&&c==u.type)return i;i++}}return-1}function en(e,t,n){t[0]=="-"?e.setProperty(t,n??""):e[t]=n==null?"":typeof n!="number"||Cs.test(t)?n:n+"px"}function Ge(e,t,n,s,o){var i,r;e:if(t=="style")if(typeof n=="string")e.style.cssText=n;else{if(typeof s=="string"&&(e.style.cssText=s=""),s)for(t in s)n&&t in n||en(e.style,t,"");if(n)for(t in n)s&&n[t]==s[t]||en(e.style,t,n[t])}else if(t[0]=="o"&&t[1]=="n")i=t!=(t=t.replace(rn,"$1")),r=t.toLowerCase(),t=r in e||t=="onFocusOut"||t=="onFocusIn"?r.slice(2):t.slice(2),e.l||(e.l={}),e.l[t+i]=n,n?s?n.u=s.u:(n.u=kt,e.addEventListener(t,i?xt:wt,i)):e.removeEventListener(t,i?xt:wt,i);else{if(o=="http://www.w3.org/2000/svg")t=t.replace(/xlink(H|:h)/,"h").replace(/sName$/,"s");else if(t!="width"&&t!="height"&&t!="href"&&t!="list"&&t!="form"&&t!="tabIndex"&&t!="download"&&t!="rowSpan"&&t!="colSpan"&&t!="role"&&t!="popover"&&t in e)try{e[t]=n??"";break e}catch{}typeof n=="function"||(n==null||n===!1&&t[4]!="-"?e.removeAttribute(t):e.setAttribute(t,t=="popover"&&n==1?"":n))}}function tn(e){return function(t){if(this.l){var n=this.l[t.type+e];if(t.t==null)t.t=kt++;else if(t.t<n.u)return;return n(x.event?x.event(t):t)}}}function Mt(e,t,n,s,o,i,r,c,u,l){var p,d,f,h,v,m,$,b,y,Me,re,Be,Ce,Xt,Ve,Te,yt,G=t.type;if(t.constructor!=null)return null;128&n.__u&&(u=!!(32&n.__u),i=[c=t.__e=n.__e]),(p=x.__b)&&p(t);e:if(typeof G=="function")try{if(b=t.props,y="prototype"in G&&G.prototype.render,Me=(p=G.contextType)&&s[p.__c],re=p?Me?Me.props.value:p.__:s,n.__c?$=(d=t.__c=n.__c).__=d.__E:(y?t.__c=d=new G(b,re):(t.__c=d=new ue(b,re),d.constructor=G,d.render=Ns),Me&&Me.sub(d),d.props=b,d.state||(d.state={}),d.context=re,d.__n=s,f=d.__d=!0,d.__h=[],d._sb=[]),y&&d.__s==null&&(d.__s=d.state),y&&G.getDerivedStateFromProps!=null&&(d.__s==d.state&&(d.__s=te({},d.__s)),te(d.__s,G.getDerivedStateFromProps(b,d.__s))),h=d.props,v=d.state,d.__v=t,f)y&&G.getDerivedStateFromProps==null&&d.componentWillMount!=null&&d.componentWillMount(),y&&d.componentDidMount!=null&&d.__h.push(d.componentDidMount);else{if(y&&G.getDerivedStateFromProps==null&&b!==h&&d.componentWillReceiveProps!=null&&d.componentWillReceiveProps(b,re),!d.__e&&d.shouldComponentUpdate!=null&&d.shouldComponentUpdate(b,d.__s,re)===!1||t.__v==n.__v){for(t.__v!=n.__v&&(d.props=b,d.state=d.__s,d.__d=!1),t.__e=n.__e,t.__k=n.__k,t.__k.some(function(Ee){Ee&&(Ee.__=t)}),Be=0;Be<d._sb.length;Be++)d.__h.push(d._sb[Be]);d._sb=[],d.__h.length&&r.push(d);break e}d.componentWillUpdate!=null&&d.componentWillUpdate(b,d.__s,re),y&&d.componentDidUpdate!=null&&d.__h.push(function(){d.componentDidUpdate(h,v,m)})}if(d.context=re,d.props=b,d.__P=e,d.__e=!1,Ce=x.__r,Xt=0,y){for(d.state=d.__s,d.__d=!1,Ce&&Ce(t),p=d.render(d.props,d.state,d.context),Ve=0;Ve<d._sb.length;Ve++)d.__h.push(d._sb[Ve]);d._sb=[]}else do d.__d=!1,Ce&&Ce(t),p=d.render(d.props,d.state,d.context),d.state=d.__s;while(d.__d&&++Xt<25);d.state=d.__s,d.getChildContext!=null&&(s=te(te({},s),d.getChildContext())),y&&!f&&d.getSnapshotBeforeUpdate!=null&&(m=d.getSnapshotBeforeUpdate(h,v)),Te=p,p!=null&&p.type===et&&p.key==null&&(Te=pn(p.props.children)),c=cn(e,Qe(Te)?Te:[Te],t,n,s,o,i,r,c,u,l),d.base=t.__e,t.__u&=-161,d.__h.length&&r.push(d),$&&(d.__E=d.__=null)}catch(Ee){if(t.__v=null,u||i!=null)if(Ee.then){for(t.__u|=u?160:128;c&&c.nodeType==8&&c.nextSibling;)c=c.nextSibling;i[i.indexOf(c)]=null,t.__e=c}else for(yt=i.length;yt--;)St(i[yt]);else t.__e=n.__e,t.__k=n.__k;x.__e(Ee,t,n)}else i==null&&t.__v==n.__v?(t.__k=n.__k,t.__e=n.__e):c=t.__e=Os(n.__e,t,n,s,o,i,r,u,l);return(p=x.diffed)&&p(t),128&t.__u?void 0:c}function dn(e,t,n){for(var s=0;s<n.length;s++)Ct(n[s],n[++s],n[++s]);x.__c&&x.__c(t,e),e.some(function(o){try{e=o.__h,o.__h=[],e.some(function(i){i.call(o)})}catch(i){x.__e(i,o.__v)}})}function pn(e){return typeof e!="object"||e==null||e.__b&&e.__b>0?e:Qe(e)?e.map(pn):te({},e)}function Os(e,t,n,s,o,i,r,c,u){var l,p,d,f,h,v,m,$=n.props,b=t.props,y=t.type;if(y=="svg"?o="http://www.w3.org/2000/svg":y=="math"?o="http://www.w3.org/1998/Math/MathML":o||(o="http://www.w3.org/1999/xhtml"),i!=null){for(l=0;l<i.length;l++)if((h=i[l])&&"setAttribute"in h==!!y&&(y?h.localName==y:h.nodeType==3)){e=h,i[l]=null;break}}if(e==null){if(y==null)return document.createTextNode(b);e=document.createElementNS(o,y,b.is&&b),c&&(x.__m&&x.__m(t,i),c=!1),i=null}if(y==null)$===b||c&&e.data==b||(e.data=b);else{if(i=i&&Ze.call(e.childNodes),$=n.props||Oe,!c&&i!=null)for($={},l=0;l<e.attributes.length;l++)$[(h=e.attributes[l]).name]=h.value;for(l in $)if(h=$[l],l!="children"){if(l=="dangerouslySetInnerHTML")d=h;else if(!(l in b)){if(l=="value"&&"defaultValue"in b||l=="checked"&&"defaultChecked"in b)continue;Ge(e,l,null,h,o)}}for(l in b)h=b[l],l=="children"?f=h:l=="dangerouslySetInnerHTML"?p=h:l=="value"?v=h:l=="checked"?m=h:c&&typeof h!="function"||$[l]===h||Ge(e,l,h,$[l],o);if(p)c||d&&(p.__html==d.__html||p.__html==e.innerHTML)||(e.innerHTML=p.__html),t.__k=[];else if(d&&(e.innerHTML=""),cn(t.type=="template"?e.content:e,Qe(f)?f:[f],t,n,s,y=="foreignObject"?"http://www.w3.org/1999/xhtml":o,i,r,i?i[0]:n.__k&&be(n,0),c,u),i!=null)for(l=i.length;l--;)St(i[l]);c||(l="value",y=="progress"&&v==null?e.removeAttribute("value"):v!=null&&(v!==e[l]||y=="progress"&&!v||y=="option"&&v!=$[l])&&Ge(e,l,v,$[l],o),l="checked",m!=null&&m!=e[l]&&Ge(e,l,m,$[l],o))}return e}function Ct(e,t,n){try{if(typeof e=="function"){var s=typeof e.__u=="function";s&&e.__u(),s&&t==null||(e.__u=e(t))}else e.current=t}catch(o){x.__e(o,n)}}function fn(e,t,n){var s,o;if(x.unmount&&x.unmount(e),(s=e.ref)&&(s.current&&s.current!=e.__e||Ct(s,null,t)),(s=e.__c)!=null){if(s.componentWillUnmount)try{s.componentWillUnmount()}catch(i){x.__e(i,t)}s.base=s.__P=null}if(s=e.__k)for(o=0;o<s.length;o++)s[o]&&fn(s[o],t,n||typeof e.type!="function");n||St(e.__e),e.__c=e.__=e.__e=void 0}function Ns(e,t,n){return this.constructor(e,n)}function Tt(e,t,n){var s,o,i,r;t==document&&(t=document.documentElement),x.__&&x.__(e,t),o=(s=typeof n=="function")?null:n&&n.__k||t.__k,i=[],r=[],Mt(t,e=(!s&&n||t).__k=Ye(et,null,[e]),o||Oe,Oe,t.namespaceURI,!s&&n?[n]:o?null:t.firstChild?Ze.call(t.childNodes):null,i,!s&&n?n:o?o.__e:t.firstChild,s,r),dn(i,e,r)}Ze=an.slice,x={__e:function(e,t,n,s){for(var o,i,r;t=t.__;)if((o=t.__c)&&!o.__)try{if((i=o.constructor)&&i.getDerivedStateFromError!=null&&(o.setState(i.getDerivedStateFromError(e)),r=o.__d),o.componentDidCatch!=null&&(o.componentDidCatch(e,s||{}),r=o.__d),r)return o.__E=o}catch(c){e=c}throw e}},nn=0,Xe=function(e){return e!=null&&e.constructor==null},ue.prototype.setState=function(e,t){var n;n=this.__s!=null&&this.__s!=this.state?this.__s:this.__s=te({},this.state),typeof e=="function"&&(e=e(te({},n),this.props)),e&&te(n,e),e!=null&&this.__v&&(t&&this._sb.push(t),Yt(this))},ue.prototype.forceUpdate=function(e){this.__v&&(this.__e=!0,e&&this.__h.push(e),Yt(this))},ue.prototype.render=et,ce=[],sn=typeof Promise=="function"?Promise.prototype.then.bind(Promise.resolve()):setTimeout,on=function(e,t){return e.__v.__b-t.__v.__b},Je.__r=0,rn=/(PointerCapture)$|Capture$/i,kt=0,wt=tn(!1),xt=tn(!0),Ms=0;var mn=function(e,t,n,s){var o;t[0]=0;for(var i=1;i<t.length;i++){var r=t[i++],c=t[i]?(t[0]|=r?1:2,n[t[i++]]):t[++i];r===3?s[0]=c:r===4?s[1]=Object.assign(s[1]||{},c):r===5?(s[1]=s[1]||{})[t[++i]]=c:r===6?s[1][t[++i]]+=c+"":r?(o=e.apply(c,mn(e,c,n,["",null])),s.push(o),c[0]?t[0]|=2:(t[i-2]=0,t[i]=o)):s.push(c)}return s},hn=new Map;function vn(e){var t=hn.get(this);return t||(t=new Map,hn.set(this,t)),(t=mn(this,t.get(e)||(t.set(e,t=function(n){for(var s,o,i=1,r="",c="",u=[0],l=function(f){i===1&&(f||(r=r.replace(/^\s*\n\s*|\s*\n\s*$/g,"")))?u.push(0,f,r):i===3&&(f||r)?(u.push(3,f,r),i=2):i===2&&r==="..."&&f?u.push(4,f,0):i===2&&r&&!f?u.push(5,0,!0,r):i>=5&&((r||!f&&i===5)&&(u.push(i,0,r,o),i=6),f&&(u.push(i,f,0,o),i=6)),r=""},p=0;p<n.length;p++){p&&(i===1&&l(),l(p));for(var d=0;d<n[p].length;d++)s=n[p][d],i===1?s==="<"?(l(),u=[u],i=3):r+=s:i===4?r==="--"&&s===">"?(i=1,r=""):r=s+r[0]:c?s===c?c="":r+=s:s==='"'||s==="'"?c=s:s===">"?(l(),i=1):i&&(s==="="?(i=5,o=r,r=""):s==="/"&&(i<5||n[p][d+1]===">")?(l(),i===3&&(u=u[0]),i=u,(u=u[0]).push(2,0,i),i=0):s===" "||s==="	"||s===`
`||s==="\r"?(l(),i=2):r+=s),i===3&&r==="!--"&&(i=4,u=u[0])}return l(),u}(e)),t),arguments,[])).length>1?t:t[0]}var a=vn.bind(Ye);var Ne,N,Et,$n,nt=0,Sn=[],j=x,_n=j.__b,gn=j.__r,bn=j.diffed,yn=j.__c,wn=j.unmount,xn=j.__;function Nt(e,t){j.__h&&j.__h(N,e,nt||t),nt=0;var n=N.__H||(N.__H={__:[],__h:[]});return e>=n.__.length&&n.__.push({}),n.__[e]}function _(e){return nt=1,As(Cn,e)}function As(e,t,n){var s=Nt(Ne++,2);if(s.t=e,!s.__c&&(s.__=[n?n(t):Cn(void 0,t),function(c){var u=s.__N?s.__N[0]:s.__[0],l=s.t(u,c);u!==l&&(s.__N=[l,s.__[1]],s.__c.setState({}))}],s.__c=N,!N.__f)){var o=function(c,u,l){if(!s.__c.__H)return!0;var p=s.__c.__H.__.filter(function(f){return!!f.__c});if(p.every(function(f){return!f.__N}))return!i||i.call(this,c,u,l);var d=s.__c.props!==c;return p.forEach(function(f){if(f.__N){var h=f.__[0];f.__=f.__N,f.__N=void 0,h!==f.__[0]&&(d=!0)}}),i&&i.call(this,c,u,l)||d};N.__f=!0;var i=N.shouldComponentUpdate,r=N.componentWillUpdate;N.componentWillUpdate=function(c,u,l){if(this.__e){var p=i;i=void 0,o(c,u,l),i=p}r&&r.call(this,c,u,l)},N.shouldComponentUpdate=o}return s.__N||s.__}function k(e,t){var n=Nt(Ne++,3);!j.__s&&Mn(n.__H,t)&&(n.__=e,n.u=t,N.__H.__h.push(n))}function de(e){return nt=5,st(function(){return{current:e}},[])}function st(e,t){var n=Nt(Ne++,7);return Mn(n.__H,t)&&(n.__=e(),n.__H=t,n.__h=e),n.__}function Rs(){for(var e;e=Sn.shift();)if(e.__P&&e.__H)try{e.__H.__h.forEach(tt),e.__H.__h.forEach(Ot),e.__H.__h=[]}catch(t){e.__H.__h=[],j.__e(t,e.__v)}}j.__b=function(e){N=null,_n&&_n(e)},j.__=function(e,t){e&&t.__k&&t.__k.__m&&(e.__m=t.__k.__m),xn&&xn(e,t)},j.__r=function(e){gn&&gn(e),Ne=0;var t=(N=e.__c).__H;t&&(Et===N?(t.__h=[],N.__h=[],t.__.forEach(function(n){n.__N&&(n.__=n.__N),n.u=n.__N=void 0})):(t.__h.forEach(tt),t.__h.forEach(Ot),t.__h=[],Ne=0)),Et=N},j.diffed=function(e){bn&&bn(e);var t=e.__c;t&&t.__H&&(t.__H.__h.length&&(Sn.push(t)!==1&&$n===j.requestAnimationFrame||(($n=j.requestAnimationFrame)||js)(Rs)),t.__H.__.forEach(function(n){n.u&&(n.__H=n.u),n.u=void 0})),Et=N=null},j.__c=function(e,t){t.some(function(n){try{n.__h.forEach(tt),n.__h=n.__h.filter(function(s){return!s.__||Ot(s)})}catch(s){t.some(function(o){o.__h&&(o.__h=[])}),t=[],j.__e(s,n.__v)}}),yn&&yn(e,t)},j.unmount=function(e){wn&&wn(e);var t,n=e.__c;n&&n.__H&&(n.__H.__.forEach(function(s){try{tt(s)}catch(o){t=o}}),n.__H=void 0,t&&j.__e(t,n.__v))};var kn=typeof requestAnimationFrame=="function";function js(e){var t,n=function(){clearTimeout(s),kn&&cancelAnimationFrame(t),setTimeout(e)},s=setTimeout(n,35);kn&&(t=requestAnimationFrame(n))}function tt(e){var t=N,n=e.__c;typeof n=="function"&&(e.__c=void 0,n()),N=t}function Ot(e){var t=N;e.__c=e.__(),N=t}function Mn(e,t){return!e||e.length!==t.length||t.some(function(n,s){return n!==e[s]})}function Cn(e,t){return typeof t=="function"?t(e):t}var Fs=Symbol.for("preact-signals");function at(){if(ne>1)ne--;else{var e,t=!1;for(function(){var o=it;for(it=void 0;o!==void 0;){var i=o.S;if(i.v===o.v)for(var r=i.t;r!==void 0;r=r.x)r.i===o.i&&(r.i=i.i);o=o.o}}();Re!==void 0;){var n=Re;for(Re=void 0,ot++;n!==void 0;){var s=n.u;if(n.u=void 0,n.f&=-3,!(8&n.f)&&En(n))try{n.c()}catch(o){t||(e=o,t=!0)}n=s}}if(ot=0,ne--,t)throw e}}function pe(e){if(ne>0)return e();At=++Ds,ne++;try{return e()}finally{at()}}var Ae,E=void 0;function je(e){var t=E,n=Ae;E=void 0,Ae=void 0;try{return e()}finally{E=t,Ae=n}}var Re=void 0,ne=0,ot=0,Ds=0,At=0,it=void 0,rt=0;function Tn(e){if(E!==void 0){var t=e.n;if(t===void 0||t.t!==E)return t={i:0,S:e,p:E.s,n:void 0,t:E,e:void 0,x:void 0,r:t},E.s!==void 0&&(E.s.n=t),E.s=t,e.n=t,32&E.f&&e.S(t),t;if(t.i===-1)return t.i=0,t.n!==void 0&&(t.n.p=t.p,t.p!==void 0&&(t.p.n=t.n),t.p=E.s,t.n=void 0,E.s.n=t,E.s=t),t}}function F(e,t){this.v=e,this.i=0,this.n=void 0,this.t=void 0,this.l=0,this.W=t?.watched,this.Z=t?.unwatched,this.name=t?.name}F.prototype.brand=Fs;F.prototype.h=function(){return!0};F.prototype.S=function(e){var t=this,n=this.t;n!==e&&e.e===void 0&&(e.x=n,this.t=e,n!==void 0?n.e=e:je(function(){var s;(s=t.W)==null||s.call(t)}))};F.prototype.U=function(e){var t=this;if(this.t!==void 0){var n=e.e,s=e.x;n!==void 0&&(n.x=s,e.e=void 0),s!==void 0&&(s.e=n,e.x=void 0),e===this.t&&(this.t=s,s===void 0&&je(function(){var o;(o=t.Z)==null||o.call(t)}))}};F.prototype.subscribe=function(e){var t=this;return we(function(){var n=t.value;je(function(){return e(n)})},{name:"sub"})};F.prototype.valueOf=function(){return this.value};F.prototype.toString=function(){return this.value+""};F.prototype.toJSON=function(){return this.value};F.prototype.peek=function(){var e=this;return je(function(){return e.value})};Object.defineProperty(F.prototype,"value",{get:function(){var e=Tn(this);return e!==void 0&&(e.i=this.i),this.v},set:function(e){if(e!==this.v){if(ot>100)throw new Error("Cycle detected");(function(n){ne!==0&&ot===0&&n.l!==At&&(n.l=At,it={S:n,v:n.v,i:n.i,o:it})})(this),this.v=e,this.i++,rt++,ne++;try{for(var t=this.t;t!==void 0;t=t.x)t.t.N()}finally{at()}}}});function S(e,t){return new F(e,t)}function En(e){for(var t=e.s;t!==void 0;t=t.n)if(t.S.i!==t.i||!t.S.h()||t.S.i!==t.i)return!0;return!1}function On(e){for(var t=e.s;t!==void 0;t=t.n){var n=t.S.n;if(n!==void 0&&(t.r=n),t.S.n=t,t.i=-1,t.n===void 0){e.s=t;break}}}function Nn(e){for(var t=e.s,n=void 0;t!==void 0;){var s=t.p;t.i===-1?(t.S.U(t),s!==void 0&&(s.n=t.n),t.n!==void 0&&(t.n.p=s)):n=t,t.S.n=t.r,t.r!==void 0&&(t.r=void 0),t=s}e.s=n}function fe(e,t){F.call(this,void 0,t),this.x=e,this.s=void 0,this.g=rt-1,this.f=4}fe.prototype=new F;fe.prototype.h=function(){if(this.f&=-3,1&this.f)return!1;if((36&this.f)==32||(this.f&=-5,this.g===rt))return!0;if(this.g=rt,this.f|=1,this.i>0&&!En(this))return this.f&=-2,!0;var e=E;try{On(this),E=this;var t=this.x();(16&this.f||this.v!==t||this.i===0)&&(this.v=t,this.f&=-17,this.i++)}catch(n){this.v=n,this.f|=16,this.i++}return E=e,Nn(this),this.f&=-2,!0};fe.prototype.S=function(e){if(this.t===void 0){this.f|=36;for(var t=this.s;t!==void 0;t=t.n)t.S.S(t)}F.prototype.S.call(this,e)};fe.prototype.U=function(e){if(this.t!==void 0&&(F.prototype.U.call(this,e),this.t===void 0)){this.f&=-33;for(var t=this.s;t!==void 0;t=t.n)t.S.U(t)}};fe.prototype.N=function(){if(!(2&this.f)){this.f|=6;for(var e=this.t;e!==void 0;e=e.x)e.t.N()}};Object.defineProperty(fe.prototype,"value",{get:function(){if(1&this.f)throw new Error("Cycle detected");var e=Tn(this);if(this.h(),e!==void 0&&(e.i=this.i),16&this.f)throw this.v;return this.v}});function B(e,t){return new fe(e,t)}function An(e){var t=e.j;if(e.j=void 0,typeof t=="function"){ne++;var n=E;E=void 0;try{t()}catch(s){throw e.f&=-2,e.f|=8,Rt(e),s}finally{E=n,at()}}}function Rt(e){for(var t=e.s;t!==void 0;t=t.n)t.S.U(t);e.x=void 0,e.s=void 0,An(e)}function Ps(e){if(E!==this)throw new Error("Out-of-order effect");Nn(this),E=e,this.f&=-2;try{8&this.f&&Rt(this)}finally{at()}}function ye(e,t){this.x=e,this.j=void 0,this.s=void 0,this.u=void 0,this.f=32,this.name=t?.name,Ae&&Ae.push(this)}ye.prototype.c=function(){var e=this.S();try{if(8&this.f||this.x===void 0)return;var t=this.x();typeof t=="function"&&(this.j=t)}finally{e()}};ye.prototype.S=function(){if(1&this.f)throw new Error("Cycle detected");this.f|=1,this.f&=-9,An(this),On(this),ne++;var e=E;return E=this,Ps.bind(this,e)};ye.prototype.N=function(){2&this.f||(this.f|=2,this.u=Re,Re=this)};ye.prototype.d=function(){this.f|=8,1&this.f||Rt(this)};ye.prototype.dispose=function(){this.d()};function we(e,t){var n=new ye(e,t);try{n.c()}catch(o){throw n.d(),o}var s=n.d.bind(n);return s[Symbol.dispose]=s,s}var Ft,jt;function xe(e,t){x[e]=t.bind(null,x[e]||function(){})}function lt(e){jt&&jt(),jt=e&&e.S()}function Rn(e){var t=this,n=e.data,s=Us(n);s.value=n;var o=st(function(){for(var i=t,r=t.__v;r=r.__;)if(r.__c){r.__c.__$f|=4;break}var c=B(function(){var l=s.value.value;return l===0?0:l===!0?"":l||""}),u=B(function(){var l;return Xe(c.value)||((l=t.base)==null?void 0:l.nodeType)!==3});return t.__$u.c=function(){var l;!Xe(o.peek())&&((l=t.base)==null?void 0:l.nodeType)===3?t.base.data=o.peek():(t.__$f|=1,t.setState({}))},we(function(){Fe||(Fe=this.N),this.N=Fn,u.value&&i.base&&(i.base.data=c.value)}),c},[]);return o.value}Rn.displayName="_st";Object.defineProperties(F.prototype,{constructor:{configurable:!0,value:void 0},type:{configurable:!0,value:Rn},props:{configurable:!0,get:function(){return{data:this}}},__b:{configurable:!0,value:1}});xe("__b",function(e,t){if(typeof t.type=="string"){var n,s=t.props;for(var o in s)if(o!=="children"){var i=s[o];i instanceof F&&(n||(t.__np=n={}),n[o]=i,s[o]=i.peek())}}e(t)});xe("__r",function(e,t){lt();var n,s=t.__c;s&&(s.__$f&=-2,(n=s.__$u)===void 0&&(s.__$u=n=function(o){var i;return we(function(){i=this}),i.c=function(){s.__$f|=1,s.setState({})},i}())),Ft=s,lt(n),e(t)});xe("__e",function(e,t,n,s){lt(),Ft=void 0,e(t,n,s)});xe("diffed",function(e,t){lt(),Ft=void 0;var n;if(typeof t.type=="string"&&(n=t.__e)){var s=t.__np,o=t.props;if(s){var i=n.U;if(i)for(var r in i){var c=i[r];c!==void 0&&!(r in s)&&(c.d(),i[r]=void 0)}else n.U=i={};for(var u in s){var l=i[u],p=s[u];l===void 0?(l=Is(n,u,p,o),i[u]=l):l.o(p,o)}}}e(t)});function Is(e,t,n,s){var o=t in e&&e.ownerSVGElement===void 0,i=S(n);return{o:function(r,c){i.value=r,s=c},d:we(function(){Fe||(Fe=this.N),this.N=Fn;var r=i.value.value;s[t]!==r&&(s[t]=r,o?e[t]=r:r?e.setAttribute(t,r):e.removeAttribute(t))})}}xe("unmount",function(e,t){if(typeof t.type=="string"){var n=t.__e;if(n){var s=n.U;if(s){n.U=void 0;for(var o in s){var i=s[o];i&&i.d()}}}}else{var r=t.__c;if(r){var c=r.__$u;c&&(r.__$u=void 0,c.d())}}e(t)});xe("__h",function(e,t,n,s){(s<3||s===9)&&(t.__$f|=2),e(t,n,s)});ue.prototype.shouldComponentUpdate=function(e,t){var n=this.__$u;if(!(n&&n.s!==void 0||4&this.__$f)||3&this.__$f)return!0;for(var s in t)return!0;for(var o in e)if(o!=="__source"&&e[o]!==this.props[o])return!0;for(var i in this.props)if(!(i in e))return!0;return!1};function Us(e){return st(function(){return S(e)},[])}var Fe;var jn=[];var Ls=function(e){queueMicrotask(function(){queueMicrotask(e)})};function Hs(){pe(function(){for(var e;e=jn.shift();)Fe.call(e)})}function Fn(){jn.push(this)===1&&(x.requestAnimationFrame||Ls)(Hs)}var De=S(innerWidth);addEventListener("resize",()=>De.value=innerWidth);var M=({title:e,note:t,id:n,children:s,className:o=""})=>a`
  <section class="card ${o}" aria-labelledby=${n}>
    <header class="card-head"><h2 id=${n}>${e}</h2>${t&&a`<p class="note">${t}</p>`}</header>
    ${s}
  </section>`,A=({problem:e})=>e&&a`
    <div class="problem" role="alert">
      <p><strong>${e.message}</strong>${e.code&&a` <span class="code">${e.code}</span>`}</p>
      ${e.hint&&a`<p>${e.hint}</p>`}
      ${e.diagnostics?.length>0&&a`<ul class="findings">
        ${e.diagnostics.slice(0,50).map(t=>a`<li>
          <span class="code">${t.code}</span> <span class="place">${Ws(t.span)}</span> ${t.message}
          ${t.hint&&a`<span class="hint"> ${t.hint}</span>`}
          ${t.excerpt&&a`<pre tabindex="0">${t.excerpt}</pre>`}
        </li>`)}
      </ul>`}
    </div>`,Ws=e=>[e.file,e.line,e.column].filter(Boolean).join(":");function z(){let e=de(null),[t,n]=_(0);return k(()=>{let s=new ResizeObserver(([o])=>n(Math.floor(o.contentRect.width)));return s.observe(e.current),()=>s.disconnect()},[]),[e,t]}var Dt="aos-token",ct=class extends Error{constructor(t){super(t.detail||t.title||"the gateway cannot be reached"),Object.assign(this,{code:"",hint:"",diagnostics:[]},t)}},q=()=>!!localStorage.getItem(Dt);async function Dn(e){localStorage.setItem(Dt,e),await fetch("/v1/session",{method:"POST",headers:Pn()})}var Pn=()=>{let e=localStorage.getItem(Dt);return e?{authorization:`Bearer ${e}`}:{}};async function Pe(e,t={}){let n;try{n=await fetch(e,{...t,headers:{...Pn(),...t.headers}})}catch{throw new ct({detail:"The gateway cannot be reached.",hint:"Is `aos serve` still running?"})}if(n.ok)return n;let s;try{s=await n.json()}catch{s={detail:`The gateway answered ${n.status}.`}}throw new ct(s)}var R=async e=>(await Pe(e)).json(),In=async e=>(await Pe(e)).blob(),Un=async e=>(await Pe(e)).text(),ae=async(e,t={})=>(await Pe(e,{method:"POST",body:JSON.stringify(t),headers:{"content-type":"application/json"}})).json(),ut=async(e,t)=>(await Pe(`${e}?name=${encodeURIComponent(t.name)}`,{method:"POST",body:t})).json();var It=["overview","why","steps","model","documents","system"],Pt=()=>{let[e,t=""]=location.hash.replace(/^#/,"").split("?"),[n="",s="",o="overview"]=e.split("/").filter(Boolean).map(decodeURIComponent),i=new URLSearchParams(t),r=Number(i.get("step"))||null;return{kind:n,name:s,view:It.includes(o)?o:"overview",step:r,token:i.get("token")}},w=S({kind:"",name:"",view:"overview",step:null}),P=(e,t="overview",n=null)=>`#/missions/${encodeURIComponent(e)}${t==="overview"?"":`/${t}`}${n?`?step=${n}`:""}`;function le(e,{replace:t=!1}={}){t?history.replaceState(null,"",e):history.pushState(null,"",e),w.value=Pt()}async function Ln(){let e=async()=>{let t=Pt();if(t.token){let n=location.hash.replace(/([?&])token=[^&]*&?/,"$1").replace(/[?&]$/,"");history.replaceState(null,"",n||"#/"),await Dn(t.token).catch(()=>{})}w.value=Pt()};addEventListener("hashchange",e),addEventListener("popstate",e),await e()}var ke=S(null),X=S(null),I=S(null),O=S(null),C=S([]),V=S([]),he=new Map,Lt=S(0),me=S(new Map),Ue=S(null),Ie=S([]),Z=S("connecting"),J=S([]),Se=S(!1),ve=S(null),Hn=S(null),Le=B(()=>C.value.at(-1)??null),$e=B(()=>w.value.step===null),g=B(()=>{let e=C.value;if(!e.length)return null;let t=w.value.step;return t===null?e.at(-1):e[Math.min(Math.max(t-e[0].step,0),e.length-1)]}),se=B(()=>g.value?g.value.step-C.value[0].step:-1),oe=B(()=>(Lt.value,g.value?he.get(g.value.step)??null:null)),pt=B(()=>{let e=new Map;for(let t of C.value.slice(0,se.value+1)){t.adopted&&e.clear();for(let n of t.drift??[]){let s=`${n.skill} ${n.response}`;e.set(s,{...n,since:e.get(s)?.since??t.step})}}return[...e.values()]}),zs=30,K=null,dt=[],Ut=!1;function U(e){let{name:t,view:n}=w.value,s=Le.value?.step;le(P(t,n,e===null||e>=s?null:Math.max(e,C.value[0]?.step??1)),{replace:!0})}async function He(){try{ke.value=(await R("/v1/runs?limit=100")).runs,X.value=null}catch(e){X.value=e}}function ft(e="",t=0){K?.close();let n=e?`?mission=${encodeURIComponent(e)}&since=${t}`:"";K=new EventSource(`/v1/events${n}`);let s=K;K.onopen=()=>Z.value=O.value?.phase==="ended"?"over":"live",K.onerror=()=>{s===K&&(Z.value="lost",s.readyState===EventSource.CLOSED&&setTimeout(()=>s===K&&qs(e),1500))};for(let o of["decision","state","service","progress","bundle","runs"])K.addEventListener(o,i=>{dt.push([o,JSON.parse(i.data)]),Ut||(Ut=!0,setTimeout(Bs,document.hidden?200:zs))})}var qs=e=>e?ht(e,{again:!0}):ft();async function ht(e,{again:t=!1}={}){let n=performance.now(),s=`/v1/missions/${encodeURIComponent(e)}`;t||Wn(),Z.value=t?"lost":"connecting";try{let[o,i]=await Promise.all([R(s),R(`${s}/trace`)]);if(w.value.name!==e)return;pe(()=>{he.clear(),I.value=o,O.value=o.state??null,Se.value=i.draws,C.value=i.steps.map(Vn),V.value=Gn(C.value),X.value=null,Hn.value=performance.now()-n}),ft(e,i.next),qn(e)}catch(o){X.value=o,t&&setTimeout(()=>w.value.name===e&&ht(e,{again:t}),1500)}}function Wn(){K?.close(),K=null,dt=[],he.clear(),pe(()=>{I.value=O.value=Ue.value=ve.value=Hn.value=null,C.value=V.value=Ie.value=J.value=[],me.value=new Map,Se.value=!1})}var zn=()=>Wn();async function qn(e){try{J.value=(await R(`/v1/missions/${encodeURIComponent(e)}/world`)).steps}catch{J.value=[]}}async function Bn(e){if(he.has(e)||!I.value)return;let{name:t}=w.value;try{let n=await R(`/v1/missions/${encodeURIComponent(t)}/decisions/${e}`);if(w.value.name!==t)return;he.set(e,n),Lt.value++}catch{}}var Vn=e=>({status:"",surprise:0,...e});function Bs(){Ut=!1;let e=dt;dt=[],pe(()=>{let t=[];for(let[n,s]of e)n==="decision"?t.push(s):n==="state"?Vs(s):n==="service"?me.value=new Map(me.value).set(s.service,s.is_there):n==="progress"?Ue.value=s:n==="bundle"?Ie.value=[s,...Ie.value].slice(0,20):n==="runs"&&(ke.value=s);t.length&&Gs(t)})}function Vs(e){if(w.value.name&&e.mission!==w.value.name){e.phase!=="waiting"&&(ve.value=e.mission);return}O.value=e,e.phase==="ended"?(Z.value="over",R(`/v1/missions/${encodeURIComponent(e.mission)}`).then(t=>w.value.name===e.mission&&(I.value=t),()=>{}),qn(e.mission)):Z.value==="over"&&(Z.value="live")}function Gs(e){let t=C.value.slice(),n=t.length;for(let{record:s,row:o}of e){let i=Vn(o),r=t.length?i.step-t[0].step:0;if(r<0)continue;let c=t[r];if(c&&c.sequence>=i.sequence)continue;t[r]=c&&s.outcome?{...c,...i,belief:{...c.belief,...i.belief},endings:c.endings,predicted:c.predicted}:i,n=Math.min(n,r);let u={...he.get(i.step)};u[s.outcome?"observed":"decided"]=s,(u.decided||!s.outcome)&&he.set(i.step,u),s.outcome&&(Ue.value=null,!J.value.includes(i.step)&&J.value.length&&(J.value=[...J.value,i.step]))}C.value=t,V.value=Gn(t,V.value,n),Lt.value++}function Gn(e,t=[],n=0){let s=t.slice(0,n+(n?1:0));for(let o=s.length?s.length-1:0;o<e.length;o++){let i={...s[o]??{},...e[o].belief??{}};s[o]=i,s[o+1]={...i,...e[o].after??{}}}return s}var L=e=>typeof e=="number"&&Number.isFinite(e);function H(e,t=2){if(!L(e))return"–";let n=Math.abs(e)>=1e3?Math.round(Math.abs(e)).toLocaleString("en"):Math.abs(e).toFixed(t);return`${e<0?"−":"+"}${n}`}function ie(e,t=Math.abs(e)){if(!L(e))return"–";let n=Math.max(0,2-Math.floor(Math.log10(t||1)));return(n>6||t>=1e6?String(Number(e.toPrecision(3))):String(Number(e.toFixed(n)))).replace("-","−")}var W=(e,t=2)=>L(e)?e.toFixed(t):"–";function T(e){return L(e)?e>.9995&&e<1?">0.999":e<5e-4&&e>0?"<0.001":e.toFixed(3):"–"}function Q(e){return L(e)?e>.995&&e<1?">99 %":e<.005&&e>0?"<1 %":`${Math.round(e*100)} %`:"–"}function We(e){return L(e)?e<.001?"<1 ms":e<1?`${Math.round(e*1e3)} ms`:e<60?`${e.toFixed(1)} s`:`${Math.floor(e/60)} min ${Math.round(e%60)} s`:""}function mt(e){let t=new Date(e);if(Number.isNaN(t.getTime()))return"";let n=t.toDateString()===new Date().toDateString(),s=t.toLocaleTimeString([],{hour:"2-digit",minute:"2-digit"});return n?`today, ${s}`:`${t.toLocaleDateString([],{day:"numeric",month:"short"})}, ${s}`}var Ks={goal:"Goal reached",over:"Over, no goal",failure:"Failed",nothing_worthwhile:"Nothing worth doing",too_risky:"Too risky",step_limit:"Step limit",skills_failed:"Skills kept failing",cancelled:"Cancelled",fault:"Fault",not_started:"Not started",stopped:"Stopped",killed:"Killed",running:"Running",unreachable:"Unreachable"},vt=e=>Ks[e]??e,Js={waiting:"Waiting",building:"Building the model",planning:"Deciding",acting:"Acting",holding:"Holding"},Kn=e=>Js[e]??e,Y=e=>e.replace(/([(,] ?)\w+=/g,"$1");function Zn(){let e=ke.value,t=(e??[]).filter(s=>s.is_running),n=(e??[]).filter(s=>!s.is_running);return a`<main class="home" id="main">
    <div class="home-list">
      <h1>Missions</h1>
      <${A} problem=${X.value} />
      ${e===null&&!X.value&&a`<p class="empty">Looking for runs…</p>`}
      ${t.length>0&&a`<h2 class="group">Running</h2><ul class="runs">${t.map(s=>a`<${Jn} key=${s.run} run=${s} />`)}</ul>`}
      ${n.length>0&&a`<h2 class="group">Past</h2><ul class="runs">${n.map(s=>a`<${Jn} key=${s.run} run=${s} />`)}</ul>`}
      ${e?.length===0&&a`<div class="welcome">
        <p>No mission has run in this folder yet.</p>
        <p>Start one here, or with <code>aos-up</code> in a terminal: it appears by itself.</p>
      </div>`}
    </div>
    <aside class="home-aside"><${Zs} /></aside>
  </main>`}function Jn({run:e}){let t=e.missions??[],n=t.at(-1)??e.run,s=e.deploy_file?.split("/").at(-1)?.replace(/\.ya?ml$/,"");return a`<li class=${e.is_running?"run is-running":"run"}>
    <a href=${P(n)}>
      <span class="run-name"><b>${e.robot}</b>${s&&s!==e.robot?a`<span class="muted">${s}</span>`:""}</span>
      <span class=${`ending is-${e.ending}`}>${e.is_running&&a`<i class="pulse"></i>`}${vt(e.ending)}</span>
      <span class="run-when muted">${mt(e.started)||e.endpoint}</span>
    </a>
    ${t.length>1&&a`<details><summary>${t.length} missions</summary><ul class="of-run">${t.slice().reverse().map((o,i)=>a`<li><a href=${P(o)}>Mission ${t.length-i}</a></li>`)}</ul></details>`}
  </li>`}function Zs(){let[e,t]=_([]),[n,s]=_(""),[o,i]=_({model:!0,stay:!1,seed:""}),[r,c]=_(null),[u,l]=_(""),p=()=>R("/v1/projects").then(v=>{t(v.projects),s(m=>m||v.projects[0]?.deploy_file||"")},c);k(()=>void p(),[]);async function d(v){v.preventDefault(),l("Starting…"),c(null);try{let m={deploy_file:n,model:o.model,stay:o.stay};o.seed!==""&&(m.seed=Number(o.seed));let $=await ae("/v1/runs",m);await He(),le(P($.mission))}catch(m){c(m)}l("")}async function f(v){let m=v.target.files[0];if(m){l(`Checking ${m.name}…`),c(null);try{let $=await ut("/v1/projects",m);await p(),s($.deploy_file)}catch($){c($)}l(""),v.target.value=""}}let h=(v,m)=>i({...o,[v]:m});return q()?a`<section class="card start" aria-labelledby="start">
    <h2 id="start">New mission</h2>
    <form onSubmit=${d}>
      <label class="field">Project
        <select value=${n} onChange=${v=>s(v.target.value)}>
          ${e.map(v=>a`<option value=${v.deploy_file}>${v.project}${v.is_uploaded?" (uploaded)":""}</option>`)}
          ${!e.length&&a`<option value="">No deploy file in this folder</option>`}
        </select></label>
      <label class="field">Seed <input inputmode="numeric" pattern="[0-9]*" placeholder="that of the file" value=${o.seed} onInput=${v=>h("seed",v.target.value)} /></label>
      <label class="check"><input type="checkbox" checked=${o.model} onChange=${v=>h("model",v.target.checked)} /> Skills are played by their documents; no robot moves</label>
      <label class="check"><input type="checkbox" checked=${o.stay} onChange=${v=>h("stay",v.target.checked)} /> Stay for further missions</label>
      <button class="primary" disabled=${!n||!!u}>Start mission</button>
      <p role="status" class="note">${u}</p>
    </form>
    <hr />
    <label class="button">Upload a bundle…<input type="file" class="visually-hidden" onChange=${f} accept=".zip,.tar,.gz,.tgz,.xz,.bz2" /></label>
    <p class="note">An archive of documents. It is checked first, and played by its own documents.</p>
    <${A} problem=${r} />
  </section>`:a`<section class="card start" aria-labelledby="start"><h2 id="start">New mission</h2>
      <p class="note">Open the address that <code>aos serve</code> prints, to start missions here. Without it this page only reads.</p></section>`}var Ht=S(null),ge=S(""),Xn=()=>q()&&I.value?.is_running&&O.value&&O.value.phase!=="ended",Xs=()=>!!O.value?.held_by||O.value?.phase==="holding";async function _e(e,t={}){let{name:n}=w.value;ge.value=e,Ht.value=null;try{await ae(`/v1/missions/${encodeURIComponent(n)}/steering`,{verb:e,...t})}catch(s){Ht.value=s}ge.value=""}function Qn(){if(ve.value)return a`<a class="button primary" href=${P(ve.value)}>To the next mission</a>`;if(!I.value?.is_running||!O.value||O.value.phase==="ended")return null;if(!q())return a`<p class="controls note">Read only</p>`;let e=!!ge.value;return a`<div class="controls" role="group" aria-label="Steering">
    ${Xs()?a`<button class="primary" disabled=${e} onClick=${()=>_e("resume")}>Go on</button>`:a`<button disabled=${e} onClick=${()=>_e("hold")}>Hold</button>`}
    <button disabled=${e} onClick=${()=>_e("step")} title="One more decision, then hold">Step</button>
    <button class="stop" disabled=${ge.value==="stop"} onClick=${()=>_e("stop")}>${ge.value==="stop"?"Stopping…":"Stop"}</button>
    <${A} problem=${Ht.value} />
  </div>`}var Yn=({action:e})=>Xn()&&a`<span class="of-action">
    <button class="quiet" disabled=${!!ge.value} onClick=${()=>_e("act",{actions:[e]})} aria-label=${`Do ${e}`}>Do</button>
    <button class="quiet" disabled=${!!ge.value} onClick=${()=>_e("leave_out",{name:e})} aria-label=${`Leave out ${e}`}>Leave out</button>
  </span>`;function es(){let e=Object.entries(O.value?.left_out??{}),t=O.value?.asked??[];return!e.length&&!t.length?null:a`<div class="left-out">
    ${t.length>0&&a`<p class="aside">Still to come: ${t.map(n=>a`<span class="chip">${n}</span> `)}</p>`}
    ${e.map(([n,s])=>a`<p class="aside"><span class="chip">${n}</span> is left out by ${s} ${Xn()&&a`<button class="link" onClick=${()=>_e("take_back",{name:n})}>Take it back</button>`}</p>`)}
  </div>`}function ts(){let[e,t]=_(!1),[n,s]=_({belief:"initial",given:"",idle:"0"}),[o,i]=_({}),[r,c]=_(null),[u,l]=_(!1),p=I.value?.run,d=O.value?.phase==="ended";if(k(()=>{!p||!d||!q()||R(`/v1/runs/${encodeURIComponent(p)}`).then(m=>t(m.is_running&&m.stays&&m.missions.at(-1)===O.value?.mission),()=>t(!1))},[p,d]),!e||ve.value||!q())return null;let f=Object.entries(I.value?.parameters??{}),h=m=>$=>s({...n,[m]:$.target.value});async function v(m){m.preventDefault(),l(!0),c(null);let $={belief:n.belief,idle:Number(n.idle||0),given:n.given.split(`
`).map(b=>b.trim()).filter(Boolean),values:o};try{le(P((await ae(`/v1/runs/${encodeURIComponent(p)}/missions`,$)).mission))}catch(b){c(b),l(!1)}}return a`<details class="card next">
    <summary>Next mission</summary>
    <form onSubmit=${v}>
      <label class="field">Belief at the start
        <select value=${n.belief} onChange=${h("belief")}><option value="initial">the initial one</option><option value="keep">the last one of this mission</option></select></label>
      <label class="field">Idle steps before it <input type="number" min="0" max="10000" value=${n.idle} onInput=${h("idle")} /></label>
      ${f.map(([m,$])=>a`<label class="field" key=${m}>${m}
        <input value=${o[m]??$} onInput=${b=>i({...o,[m]:b.target.value})} /></label>`)}
      <label class="field wide">What is known, one expression a line <textarea rows="2" placeholder="state.robot_at == Kitchen" value=${n.given} onInput=${h("given")}></textarea></label>
      <button class="primary" disabled=${u}>${u?"Beginning…":"Begin it"}</button>
    </form>
    <${A} problem=${r} />
  </details>`}var ns=["#4477aa","#ccbb44","#66ccee","#aa3377","#228833","#ee6677","#8a8f98"],Qs=new Set(["#ccbb44","#66ccee","#ee6677"]),Ys=new Set(["false","no","none","0"]),Wt=e=>ns[e%ns.length],$t=e=>e.startsWith("var")?"var(--ink)":Qs.has(e)?"#14171a":"#ffffff";function ss(e){let t=new Map,n=0;for(let s of e){let o=Ys.has(s.toLowerCase())||s==="…";t.set(s,o?"var(--quiet)":Wt(n++))}return t}var zt=26,eo=2,D=(e,t,n=0)=>n+e/Math.max(1,C.value.length)*(t-n),ze=e=>e.impossible||e.surprise>=eo,_t=e=>e.chosen_by==="operator"||e.chosen_by==="script",qe=e=>!!e.status&&e.status!=="observed",to=()=>{let e=new Map;for(let t of C.value)e.has(t.skill)||e.set(t.skill,Wt(e.size));return e};function qt({room:e,height:t,head:n=0}){if(se.value<0)return null;let s=D(se.value,e,n),o=D(se.value+1,e,n);return a`<rect class="cursor" x=${s+.75} y="0.75" width=${Math.max(1.5,o-s-1.5)} height=${t-1.5} rx="2" />`}function os(){let[e,t]=z(),n=C.value,s=to(),o=g.value;if(!n.length)return a`<div class="timeline" ref=${e}></div>`;let i=n[0].step,r=Le.value.step;return a`<div class="timeline">
    <div class="timeline-track" ref=${e}>
      <svg width=${t} height=${zt+12} aria-hidden="true">
        <g transform="translate(0 12)">
          ${t>0&&no(n,t,s)}
          <${qt} room=${t} height=${zt} />
        </g>
        ${t>0&&so(n,t)}
      </svg>
      <input type="range" min=${i} max=${r} step="1" value=${o.step}
        aria-label="Step" aria-valuetext=${`step ${o.step}, ${o.action}`}
        onInput=${c=>U(Number(c.target.value))} />
    </div>
    <div class="timeline-foot">
      <ul class="legend" aria-label="Skills">
        ${[...s].map(([c,u])=>a`<li><i style=${{background:u}}></i>${c}</li>`)}
        ${n.some(ze)&&a`<li><svg width="10" height="9" aria-hidden="true"><path class="surprise" d="M5 0 l5 9 h-10z" /></svg>surprise</li>`}
        ${n.some(qe)&&a`<li><svg width="9" height="9" aria-hidden="true"><path class="failed" d="M1 1 l7 7 M8 1 l-7 7" /></svg>not observed</li>`}
        ${n.some(_t)&&a`<li><svg width="9" height="9" aria-hidden="true"><rect class="asked" x="1" y="1" width="7" height="7" rx="1" /></svg>asked for by a person</li>`}
        ${n.some(c=>c.adopted)&&a`<li><svg width="9" height="9" aria-hidden="true"><path class="adopted" d="M4.5 0 l4.5 4.5 l-4.5 4.5 l-4.5 -4.5z" /></svg>new model</li>`}
      </ul>
      <div class="stepper">
        <button class="quiet" onClick=${()=>U(o.step-1)} disabled=${o.step<=i} aria-label="Step before">‹</button>
        <span class="stepper-place"><b>${o.step}</b> of ${r}</span>
        <button class="quiet" onClick=${()=>U(o.step+1)} disabled=${o.step>=r} aria-label="Step after">›</button>
        <button class=${`quiet newest ${$e.value?"is-on":""}`} aria-pressed=${$e.value} onClick=${()=>U(null)}>
          ${O.value?.phase==="ended"?"Last":"Newest"}</button>
      </div>
    </div>
  </div>`}function no(e,t,n){let s=D(1,t)-D(0,t),o=s>6?2:0,i=[];for(let r=0;r<e.length;){let c=r+1;if(!o)for(;c<e.length&&e[c].skill===e[r].skill;)c++;let u=n.get(e[r].skill),l=Math.max(1,(c-r)*s-o),p=Y(e[r].action),d=!e[r].status;i.push(a`<rect class=${d?"open":""} x=${D(r,t)} y="0" width=${l} height=${zt} rx="2" style=${{fill:u,stroke:d?u:"none"}} />`),l>p.length*7.2+12&&i.push(a`<text x=${D(r,t)+6} y="17" style=${{fill:d?"var(--ink)":$t(u)}}>${p}</text>`),r=c}return i}function so(e,t){return e.map((n,s)=>{let o=D(s+.5,t);return[ze(n)&&a`<path class="surprise" d=${`M${o} 1 l4.5 8 h-9z`}><title>${`step ${n.step}: surprise ${n.impossible?"without end":W(n.surprise)}, expected with ${T(n.expected)}`}</title></path>`,qe(n)&&a`<path class="failed" d=${`M${o-3.5} 2 l7 7 M${o+3.5} 2 l-7 7`} />`,_t(n)&&a`<rect class="asked" x=${D(s+.5,t)-(ze(n)||qe(n)?12:3.5)} y="2" width="7" height="7" rx="1" />`,n.adopted&&a`<path class="adopted" d=${`M${D(s,t)} 1 l4 4 l-4 4 l-4 -4z`} />`]})}function is(){let e=g.value;return e?a`<div class="decision">
    <p class="sentence"><span class="action">${e.action}</span> ${oo(e)}</p>
    <p class="came">${io(e)}</p>
    ${e.fault&&a`<p class="came fault">${e.fault}</p>`}
    ${e.remark&&a`<p class="came">${e.remark}</p>`}
    ${e.adopted&&a`<p class="came">A new model decided: ${e.adopted}.</p>`}
  </div>`:a`<p class="sentence muted">${O.value?.remark?`${O.value.remark}.`:"No decision has been made yet."}</p>`}function oo(e){let t=[e.planner,e.simulations?`${e.simulations.toLocaleString("en")} simulations`:"",We(e.planning_s)].filter(Boolean).join(", "),n=t&&a`<span class="by">${t}</span>`;if(_t(e))return e.chosen_by==="script"?a`comes from a script of a person.`:a`was asked for by a person.`;if(!L(e.value))return a`was chosen. ${n}`;let s=a`is worth <b>${H(e.value)}</b>${e.error>=.005?` ± ${W(e.error)}`:""}`;if(!e.second)return a`${s}; nothing else can be done. ${n}`;let o=Math.hypot(e.error??0,e.second_error??0),i=a`<span class="other">${e.second}</span>`;return L(e.margin)&&Math.abs(e.margin)<2*o?a`${s}, too close to call against ${i}. ${n}`:e.margin<0?a`${s}, ${W(-e.margin)} less than ${i}. ${n}`:e.margin===0?a`${s}, as much as ${i}. ${n}`:a`${s}, <b>${W(e.margin)}</b> more than ${i}. ${n}`}function io(e){let n=Object.entries(e.predicted??{}).sort((i,r)=>r[1]-i[1]).slice(0,3).map(([i,r],c)=>a`${c?", ":""}<span class="response">${i}</span> ${Q(r)}`);if(!e.status){let i=Ue.value;return a`Expected ${n}. ${i&&i.id?.step===e.step?`${i.state}${i.progress?`, ${Q(i.progress)}`:""}${i.text?`: ${i.text}`:""}`:a`<span class="waiting">It is running.</span>`}`}if(e.status!=="observed")return a`Expected ${n}. Nothing was observed: <b>${e.status.replace("_"," ")}</b>.`;let s=e.impossible?"The model held that impossible.":`Surprise ${W(e.surprise)}.`,o=e.stopped_by?` It was stopped by ${e.stopped_by}.`:"";return a`Expected ${n}. Saw <b class="response">${e.seen}</b>${L(e.expected)?` (${T(e.expected)})`:""}${ro()}.${o} ${s}`}function ro(){let e=Object.entries(oe.value?.observed?.outcome?.numbers??{}),t=n=>[n].flat().slice(0,4).map(s=>L(s)?ie(s):"–").join(" ")+([n].flat().length>4?" …":"");return e.length?a`, ${e.map(([n,s])=>`${n} = ${t(s)}`).join(", ")}`:""}var ao=[.05,.25,.5,.75,.95],lo=2;function co(e){if(!e||Array.isArray(e))return e??null;let t=Object.entries(e).map(([s,o])=>[Number(s),o]).filter(([s])=>Number.isFinite(s));t.sort((s,o)=>s[0]-o[0]);let n=t.reduce((s,[,o])=>s+o,0);return n?ao.map(s=>{let o=0;return t.find(([,i])=>(o+=i)>=s*n-1e-9)?.[0]??t.at(-1)[0]}):null}var rs=([e,,t,,n],s)=>[["median",ie(t,s)],["5–95 %",`${ie(e,s)} … ${ie(n,s)}`]];function as(e,t){let n=t.map(u=>co(u[e])),s=n.filter(Boolean),o=Math.min(...s.map(u=>u[0])),i=Math.max(...s.map(u=>u[4])),r=i-o||1,c={name:e,isNumber:!0,series:n,low:o,high:i,values:[ie(s[0][2])],doubt:0,isDoubtful:!1,isMoving:!1,moves:[]};return n.forEach((u,l)=>{if(!u)return;c.doubt+=lo*(u[4]-u[0])/r,u[4]>u[0]&&(c.isDoubtful=!0);let p=n[l-1];!p||p===u||(u.some((d,f)=>Math.abs(d-p[f])>1e-4*r)&&(c.isMoving=!0),(u[2]<p[1]||u[2]>p[3])&&c.moves.push(l))}),c}function ls({row:e,room:t,head:n,height:s}){let o=e.series.length-1;if(o<1)return null;let i=Math.min(8,t/o*.4),r=e.high-e.low||1,c=p=>2+(s-4)*(1-(p-e.low)/r),u=p=>e.series.flatMap((d,f)=>{if(!d)return[];let h=f===0?0:D(f-1,t,n)+i/2,v=f===o?t:Math.max(h,D(f,t,n)-i/2);return[`${h.toFixed(1)} ${c(d[p]).toFixed(1)}`,`${v.toFixed(1)} ${c(d[p]).toFixed(1)}`]}),l=(p,d)=>`M${[...u(d),...u(p).reverse()].join("L")}Z`;return a`
    <path class="fan-most" d=${l(0,4)} />
    <path class="fan-half" d=${l(1,3)} />
    <path class="fan-median" d=${`M${u(2).join("L")}`} />
    <text class="fan-end" x="3" y="10">${ie(e.high,r)}</text>
    <text class="fan-end" x="3" y=${s-2}>${ie(e.low,r)}</text>`}var ee=40,Bt=8,uo=12,po=.2;function us(){let[e,t]=z(),[n,s]=_(!1),o=V.value,i=Gt(o),r=i.filter(p=>p.isDoubtful||p.isMoving),c=n?r:r.slice(0,Bt),u=i.filter(p=>!p.isDoubtful&&!p.isMoving),l=se.value;return a`<div class="ribbons" ref=${e}>
    ${t>0&&c.map(p=>a`<${fo} key=${p.name} row=${p} all=${o} size=${t} now=${l} />`)}
    ${r.length>Bt&&a`<button class="link" onClick=${()=>s(!n)}>
      ${n?"Show fewer":`Show ${r.length-Bt} more`}</button>`}
    ${u.length>0&&a`<p class="still"><span>Certain throughout</span>
      ${u.slice(0,40).map(p=>a`<span class="chip"><b>${p.name}</b> ${p.values[0]}</span>`)}</p>`}
    ${!i.length&&a`<p class="empty">There is no belief yet.</p>`}
  </div>`}function fo({row:e,all:t,size:n,now:s}){let o=De.value<720,i=Math.max(60,o?n:n-330),r=gt(i),c=ss(e.values),u=t[s+1]?.[e.name]??{},l=Array.isArray(u)?rs(u,e.high-e.low):ho(u),p=l.map(([d,f])=>`${d} ${f}`).join(", ");return a`<div class="ribbon">
    <h3 class="ribbon-name">${e.name}</h3>
    <svg class=${i>4*t.length?"ribbon-plot":"ribbon-plot is-dense"} width=${i} height=${ee} role="img" aria-label=${`${e.name}: ${p}`}
      onClick=${d=>U(mo(d,i))}>
      ${e.isNumber?a`<${ls} row=${e} all=${t} room=${i} head=${r} height=${ee} />`:vo(e,t,i,c)}
      ${e.moves.length<=uo&&e.moves.map(d=>a`<path class="moved" d=${`M${D(d-1,i,r)} ${ee} l-3.5 5 h7 z`} />`)}
      ${!e.isNumber&&$o(e,t,i,c)}
      <${qt} room=${i} height=${ee} head=${r} />
    </svg>
    <dl class=${e.isNumber?"ribbon-now is-number":"ribbon-now"}>
      ${l.map(([d,f])=>a`<div><dt>${!e.isNumber&&a`<i style=${{background:c.get(d)}}></i>`}${d}</dt><dd>${f}</dd></div>`)}
    </dl>
  </div>`}var ho=e=>Object.entries(e).sort((t,n)=>n[1]-t[1]).slice(0,2).map(([t,n])=>[t,T(n)]),gt=e=>Math.min(24,e/(C.value.length+.5)*.5),mo=(e,t)=>{let n=C.value.length,s=e.clientX-e.currentTarget.getBoundingClientRect().left,o=gt(t),i=Math.min(n-1,Math.max(0,Math.floor((s-o)/(t-o)*n)));return C.value[i]?.step};function vo(e,t,n,s){let o=t.length-1;if(o<1)return null;let i=gt(n),r=Math.min(8,n/o*.4),c=new Float64Array(t.length);return e.values.map(u=>{let l="",p="",d=!1;for(let f=0;f<=o;f++){let h=t[f][e.name]?.[u]??0;h>0&&(d=!0);let v=ee-c[f]*ee;c[f]+=h;let m=ee-c[f]*ee,$=f===0?0:D(f-1,n,i)+r/2,b=f===o?n:Math.max($,D(f,n,i)-r/2);l+=`${l?"L":"M"}${$.toFixed(1)} ${m.toFixed(1)}L${b.toFixed(1)} ${m.toFixed(1)}`,p=`L${b.toFixed(1)} ${v.toFixed(1)}L${$.toFixed(1)} ${v.toFixed(1)}${p}`}return d?a`<path d=${`${l}${p}Z`} style=${{fill:s.get(u)}} />`:null})}function $o(e,t,n,s){let o=[],i=t.length-1,r=gt(n),c=0,u=null,l=p=>{let d=c===0?0:D(c-1,n,r),f=p>i?n:D(p-1,n,r);if(!u||f-d<u.length*7+14)return;let h=0,v=t[c][e.name]??{};for(let $ of e.values){if($===u)break;h+=v[$]??0}let m=ee-(h+(v[u]??0)/2)*ee;o.push(a`<text x=${d+8} y=${m+4} style=${{fill:$t(s.get(u))}}>${u}</text>`)};for(let p=0;p<=i;p++){let[d,f]=Object.entries(t[p][e.name]??{}).reduce((v,m)=>m[1]>v[1]?m:v,["",0]),h=f>=.5?d:null;h!==u&&(l(p),c=p,u=h)}return l(i+1),o}var Vt={all:null,rows:[]};function Gt(e){if(Vt.all===e)return Vt.rows;let t=new Map,n=_o(e);for(let o=0;o<e.length;o++)for(let i in e[o]){if(n.has(i))continue;let r=e[o][i],c=o?e[o-1][i]:void 0,u=t.get(i);u||t.set(i,u={name:i,weights:new Map,doubt:0,isDoubtful:!1,isMoving:!1,moves:[]});let l=0;for(let p in r){let d=r[p];u.weights.set(p,(u.weights.get(p)??0)+d),d>0&&d<1&&(l-=d*Math.log(d))}if(l>.005&&(u.isDoubtful=!0),u.doubt+=l,c&&c!==r){let p=bo(c,r);p>1e-4&&(u.isMoving=!0),p>=po&&u.moves.push(o)}}let s=[...t.values()].map(o=>({...o,values:[...o.weights.entries()].sort(go).map(([i])=>i)}));for(let o of n)s.push(as(o,e));return s.sort((o,i)=>i.doubt-o.doubt||i.moves.length-o.moves.length),Vt={all:e,rows:s},s}function _o(e){let t=new Set;for(let n of e)for(let s in n)Array.isArray(n[s])&&t.add(s);return t}var cs=e=>e==="true"?-1:e==="false"||e==="…"?1:0,go=(e,t)=>cs(e[0])-cs(t[0]);function bo(e,t){let n=0;for(let s in e)n+=Math.abs(e[s]-(t[s]??0));for(let s in t)s in e||(n+=t[s]);return n/2}var ds=8,yo=30;function ps(){let[e,t]=z(),[n,s]=_(!1),o=oe.value?.decided??oe.value?.observed;if(!g.value||!o||o.step!==g.value.step)return a`<div ref=${e} class="values" aria-busy="true"></div>`;let i=o.actions.filter(l=>L(l.q)).sort((l,p)=>p.q-l.q),r=n?i:i.slice(0,ds),c=i.find(l=>l.action===o.action);c&&!r.includes(c)&&(r=[...r,c]);let u=xo(r);return a`<div class="values" ref=${e}>
    <ol>
      ${r.map(l=>a`<${wo} key=${l.action} each=${l} scale=${u} size=${t} found=${o} />`)}
    </ol>
    ${i.length>ds&&a`<button class="link" onClick=${()=>s(!n)}>${n?"Show fewer":`Show all ${i.length}`}</button>`}
    ${!i.length&&a`<p class="empty">${o.planner?`${o.planner} gives no values.`:"There are no values."}</p>`}
    ${Object.entries(o.set_aside??{}).map(([l,p])=>a`<p class="aside"><b>${l}</b> is set aside: ${p}</p>`)}
    ${(o.constraints??[]).map(l=>a`<p class="aside">Never <code>${l.never}</code>: risks ${l.risk.toPrecision(2)} of ${l.left.toPrecision(2)} that are left.</p>`)}
  </div>`}function wo({each:e,scale:t,size:n,found:s}){let o=e.action===s.action,i=Math.max(80,n-(De.value<480?84:92)),r=l=>t(l)*(i-16)+8,c=e.stderr??0,u=`${e.action}: ${H(e.q)}${c>=.005?` ± ${c.toFixed(2)}`:""}${o?", chosen":""}`;return a`<li class=${o?"value is-chosen":"value"} aria-label=${u}>
    <span class="value-head"><span class="value-name" title=${e.action}>${o&&a`<span class="chosen-mark" aria-hidden="true">▸</span>`}${Y(e.action)}</span><${Yn} action=${e.action} /></span>
    <span class="value-plot">
      <svg width=${i} height=${yo-12} aria-hidden="true">
        <line class="rail" x1="8" x2=${i-8} y1="9" y2="9" />
        ${L(e.at_least)&&L(e.at_most)&&a`<line class="proven" x1=${r(e.at_least)} x2=${r(e.at_most)} y1="9" y2="9" />`}
        ${c>0&&a`<line class="error" x1=${r(e.q-2*c)} x2=${r(e.q+2*c)} y1="9" y2="9" />`}
        <circle cx=${r(e.q)} cy="9" r=${o?5.5:4} />
      </svg>
      <span class="value-number">${H(e.q)}</span>
    </span>
  </li>`}function xo(e){let t=e.flatMap(o=>[o.q-2*(o.stderr??0),o.q+2*(o.stderr??0)]).filter(L),n=Math.min(...t),s=Math.max(...t)-n||1;return o=>Math.min(1,Math.max(0,(o-n)/s))}var ko=4,So=3;function hs({name:e,step:t,seen:n}){let[s,o]=_(0),[i,r]=_(null),[c,u]=_(null),[l,p]=_(!1);k(()=>{if(!s)return;let f=!0;return p(!0),u(null),R(`/v1/missions/${encodeURIComponent(e)}/decisions/${t}/tree?depth=${s}&branches=${So}`).then(h=>f&&r(h),h=>f&&u(h)).then(()=>f&&p(!1)),()=>{f=!1}},[s]);let d=f=>a`<button class="quiet" disabled=${l} onClick=${()=>o(f)}>${l?"Growing…":f>2?"One decision deeper":"Show the tree"}</button>`;return a`<${M} id="tree" title="Looking ahead" className="tree" note="The best actions with value, error and simulations; after each the likeliest responses. Every belief is planned anew.">
    <${A} problem=${c} />
    <div role="status" aria-busy=${l}>${i&&a`<${ms} node=${i.root} seen=${n} />
      ${!i.is_whole&&a`<p class="aside">The rest was left out for its size.</p>`}`}</div>
    ${s?s<ko&&d(s+(c?0:1)):d(2)}
  <//>`}function ms({node:e,seen:t}){return e.actions?.length?a`<ul class="branches">${e.actions.map((n,s)=>a`<li>
    ${n.after?.length?a`<details open=${t!==void 0&&s===0}><summary><${fs} each=${n} /></summary>
          <ul class="branches">${n.after.map(([o,i,r])=>a`<li><details open=${o===t}>
            <summary><span class="response">${o}</span> <span class="muted">${Q(i)}, goal ${T(r.goal_probability)}${o===t?", seen":""}</span></summary>
            <${ms} node=${r} />
          </details></li>`)}</ul>
        </details>`:a`<${fs} each=${n} />`}
  </li>`)}</ul>`:a`<p class="muted">over; goal ${T(e.goal_probability)}</p>`}var fs=({each:e})=>a`<span class="action">${e.action}</span> <b>${H(e.q)}</b>${e.stderr>=.005&&a` <span class="muted">± ${e.stderr.toFixed(2)}</span>`}${e.n>0&&a` <span class="muted">${e.n.toLocaleString("en")} simulations</span>`}`;var Kt=new Map,vs=e=>e.margin<0?e.action:e.other,Mo=e=>({operator:", which an operator has asked for",script:", which a script has asked for"})[e.chosen_by]??"";function $s(){let[e,t]=_(""),[n,s]=_(null),[o,i]=_(null),r=g.value?.step,{name:c}=w.value;if(k(()=>t(""),[c,r]),k(()=>{if(!r)return;let l=`/v1/missions/${encodeURIComponent(c)}/decisions/${r}/why?instead=${encodeURIComponent(e)}`;if(i(null),s(Kt.get(l)??null),Kt.has(l))return;let p=!0,d=setTimeout(()=>R(l).then(f=>{g.value?.status&&Kt.set(l,f),p&&s(f)},f=>p&&i(f)),150);return()=>{p=!1,clearTimeout(d)}},[c,r,e]),!r)return a`<p class="empty">There is no decision yet.</p>`;let u=(oe.value?.decided?.actions??[]).map(l=>l.action).filter(l=>l!==g.value.action);return a`<div class="why" aria-busy=${!n&&!o}>
    <p class="why-head">Why <span class="action">${g.value.action}</span>${n&&Mo(n)}
      <label> and not <select value=${e} onChange=${l=>t(l.target.value)}>
        <option value="">the runner-up${n&&!e?`, ${n.other}`:""}</option>
        ${u.map(l=>a`<option value=${l}>${l}</option>`)}
      </select></label></p>
    <${A} problem=${o} />
    ${!n&&!o&&a`<p class="empty">An engine of its own is brought to this step…</p>`}
    ${n&&a`<${Co} why=${n} />`}
    ${r&&a`<${hs} key=${`tree ${c} ${r}`} name=${c} step=${r} seen=${g.value.seen} />`}
    ${r&&a`<${Ao} key=${`${c} ${r}`} name=${c} step=${r} />`}
  </div>`}var Co=({why:e})=>a`<div class="columns even">
  <${M} id="margin" title="Where the margin comes from" note=${To(e)}><${Eo} why=${e} /><//>
  <div class="stack">
    <${M} id="flips" title="At which belief the choice changes" note=${e.flips?.length?"Coloured: the action that is better now. Grey: the other one. The line is the belief now.":""}><${Oo} why=${e} /><//>
    <${M} id="leads" title="What each response leads to"><${No} why=${e} /><//>
  </div>
</div>`;function To(e){if(e.is_close){let n=e.simulations_to_tell?`about ${e.simulations_to_tell.toLocaleString("en")} simulations would tell`:"no number of simulations is sure to tell";return`Too close to call against ${e.other}: ${n}.`}let t=e.margin_stderr>=.005?` ± ${W(e.margin_stderr)}`:"";return`${H(e.margin)}${t} over ${e.other}, ${e.is_exact?"exactly":`by ${e.planner}`}.`}function Eo({why:e}){let[t,n]=z(),s=(e.terms??[]).map(l=>({...l,margin:l.value-l.other})).filter(l=>Math.abs(l.margin)>5e-4),o=(e.rest??0)-(e.other_rest??0);Math.abs(o)>5e-4&&s.push({place:"later steps",margin:o});let i=Math.max(...s.map(l=>Math.abs(l.margin)),1e-9),r=Math.max(80,n-(n<420?190:250)),c=l=>r/2+l/i*(r/2-2),u=P(w.value.name,"documents",w.value.step);return a`<div class="terms" ref=${t}>
    ${!s.length&&a`<p class="empty">${e.remark||"No line of the documents tells them apart."}</p>`}
    <ul>${s.slice(0,12).map(l=>a`<li aria-label=${`${H(l.margin,3)} from ${l.place}`}>
      <span class="term-place">${l.place==="later steps"?l.place:a`<a href=${u}>${l.place}</a>`}</span>
      <svg width=${r} height="18" aria-hidden="true">
        <line class="rail" x1=${r/2} x2=${r/2} y1="0" y2="18" />
        <rect class=${l.margin>0?"for":"against"} x=${Math.min(c(0),c(l.margin))} y="4" width=${Math.max(1,Math.abs(c(l.margin)-c(0)))} height="10" rx="2" />
      </svg>
      <span class="number">${H(l.margin,2)}</span>
    </li>`)}</ul>
    ${e.remark&&s.length>0&&a`<p class="aside">${e.remark}</p>`}
  </div>`}function Oo({why:e}){let[t,n]=z(),s=Math.max(100,n),o=r=>r*s,i=(e.flips??[]).slice(0,5);return a`<div class="flips" ref=${t}>
    ${!i.length&&a`<p class="empty">${e.remark||`No probability of one value makes ${vs(e)} better.`}</p>`}
    ${i.map(r=>{let c=(r.low+r.high)/2>r.now,[u,l]=c?[r.high,1]:[0,r.low],p=c?"above":"below",d=r.high-r.low>.001?`${p} a probability between ${T(r.low)} and ${T(r.high)}`:`${p} ${T((r.low+r.high)/2)}`;return a`<figure class="flip">
        <figcaption>P(<span class="code">${r.variable} = ${r.value}</span>) is ${T(r.now)}; ${Y(vs(e))} wins ${d}${r.is_checked?"":", not checked by planning"}</figcaption>
        <svg width=${s} height="22" aria-hidden="true">
          <rect class="this" x="0" y="3" width=${s} height="16" rx="3" />
          <rect class="between" x=${o(r.low)} y="3" width=${Math.max(1,o(r.high)-o(r.low))} height="16" />
          <rect class="other" x=${o(u)} y="3" width=${Math.max(1,o(l)-o(u))} height="16" rx="3" />
          <line class="now" x1=${o(r.now)} x2=${o(r.now)} y1="0" y2="22" />
        </svg>
      </figure>`})}
  </div>`}var No=({why:e})=>a`<ul class="leads">
  ${(e.expected??[]).map(t=>a`<li class=${t.is_seen?"is-seen":""}>
    <p><span class="response">${t.response}</span> <span class="muted">${Q(t.probability)}</span>${t.is_seen&&a` <b>seen</b>`}</p>
    <p class="muted">${t.action?a`goal ${T(t.goal_probability??0)}; next would be <span class="response">${t.action}</span>, worth ${H(t.value)}`:`goal ${T(t.goal_probability??0)}; the mission would be over`}</p>
  </li>`)}
</ul>`;function Ao({name:e,step:t}){let[n,s]=_({forbid:"",without:"",believe:"",change:""}),[o,i]=_(null),[r,c]=_(null),[u,l]=_(!1);if(!q())return null;let p=[["forbid","Without this action now",g.value?.action??""],["without","Without this skill for good",g.value?.skill??""],["believe","With another belief","variable=value:0.5"],["change","With another number in the documents","file:line=number"]];async function d(f){f.preventDefault(),l(!0),c(null);let h={};for(let[v]of p)n[v].trim()&&(h[v]=[n[v].trim()]);try{i(await ae(`/v1/missions/${encodeURIComponent(e)}/decisions/${t}/whatif`,h))}catch(v){i(null),c(v)}l(!1)}return a`<${M} id="whatif" title="What if" className="whatif" note="The step is decided anew; the mission is not touched.">
    <form onSubmit=${d}>
      ${p.map(([f,h,v])=>a`<label class="field">${h}<input value=${n[f]} placeholder=${v} onInput=${m=>s({...n,[f]:m.target.value})} /></label>`)}
      <button class="primary" disabled=${u}>${u?"Deciding…":"Decide anew"}</button>
    </form>
    <div role="status">${o&&a`<p class="supposed">${o.action===o.before?"Still ":"Then "}<b class="action">${o.action}</b>, worth <b>${H(o.value)}</b>${o.action===o.before?"":a`, in place of ${o.before} with ${H(o.value_before)}`}.</p>
      ${(o.supposed??[]).map(f=>a`<p class="muted">Supposed: ${f}</p>`)}
      ${o.remark&&a`<p class="muted">${o.remark}</p>`}`}</div>
    <${A} problem=${r} />
  <//>`}var gs=()=>a`<div class="columns even">
  <${Ro} />
  <${M} id="expected" title="Expected against seen" note="The ring is how often the model expected a response, the dot how often it came; the bar holds the true frequency with 95 %.">
    <${Do} />
  <//>
  <${M} id="strip" title="Decision strip" note="What was chosen at which probability, in this mission. The larger a dot, the more often.">
    <${Po} />
  <//>
</div>`;function Ro(){let e=pt.value;return e.length?a`<${M} id="alarms" title="The model does not hold" className="alarms" note="Where the model is right, the probability that any such alarm ever comes is 1 % at most.">
    <div class="scroll" tabindex="0" role="region" aria-label="Table of alarms"><table>
      <thead><tr><th>Skill</th><th>Response</th><th class="num">Modelled</th><th class="num">Seen</th><th class="num">Uses</th><th class="num" title="The step at which it began">Since</th></tr></thead>
      <tbody>${e.map(t=>a`<tr onClick=${()=>U(t.since)}>
        <td class="action">${t.skill}</td><td class="response">${t.response}</td>
        <td class="num">${W(t.modelled)}</td><td class="num mark">${W(t.seen)}</td><td class="num">${t.uses}</td>
        <td class="num"><button class="row-step" aria-label=${`Step ${t.since}`}>${t.since}</button></td>
      </tr>`)}</tbody>
    </table></div>
  <//>`:null}function jo(){let e=new Map;for(let t of C.value){if(t.status!=="observed")continue;e.has(t.skill)||e.set(t.skill,{uses:0,responses:new Map});let n=e.get(t.skill);n.uses++;let s=new Set([...Object.keys(t.predicted??{}),t.seen]);for(let o of s){let i=n.responses.get(o)??{expected:0,seen:0};i.expected+=t.predicted?.[o]??0,o===t.seen&&i.seen++,n.responses.set(o,i)}}return e}function Fo(e,t){let s=e/t,o=(s+1.96*1.96/(2*t))/(1+1.96*1.96/t),i=1.96*Math.sqrt(s*(1-s)/t+1.96*1.96/(4*t*t))/(1+1.96*1.96/t);return[Math.max(0,o-i),Math.min(1,o+i)]}function Do(){let[e,t]=z(),n=jo(),s=Math.max(90,t-(t<480?132:250)),o=i=>8+i*(s-16);return a`<div class="expected" ref=${e}>
    ${!n.size&&a`<p class="empty">Nothing has been observed yet.</p>`}
    ${[...n].map(([i,{uses:r,responses:c}])=>a`<div class="skill" key=${i}>
      <h3>${i} <span class="muted">${r} ${r===1?"use":"uses"}</span></h3>
      <ul>${[...c].sort((u,l)=>l[1].seen-u[1].seen).map(([u,{expected:l,seen:p}])=>{let[d,f]=Fo(p,r),h=l/r,v=h<d||h>f;return a`<li class=${v?"is-off":""} aria-label=${`${u}: expected ${Q(h)}, seen ${Q(p/r)}, ${p} of ${r}${v?", outside of the interval":""}`}>
          <span class="response-name">${u}</span>
          <svg width=${s} height="18" aria-hidden="true">
            <line class="rail" x1="8" x2=${s-8} y1="9" y2="9" />
            <line class="error" x1=${o(d)} x2=${o(f)} y1="9" y2="9" />
            <circle class="ring" cx=${o(h)} cy="9" r="5.5" />
            <circle class="dot" cx=${o(p/r)} cy="9" r="3.5" />
          </svg>
          <span class="number">${p}/${r}${v?a` <b title="The model's frequency is outside of the interval">!</b>`:""}</span>
        </li>`})}</ul>
    </div>`)}
  </div>`}function Po(){let[e,t]=z(),[n,s]=_(""),i=Gt(V.value).filter(m=>m.isDoubtful&&!m.isNumber).flatMap(m=>m.values.filter($=>$!=="…"&&!($==="false"&&m.values.includes("true"))).map($=>`${m.name} = ${$}`)),r=i.includes(n)?n:i[0];if(!r)return a`<div ref=${e}><p class="empty">No variable is in doubt.</p></div>`;let[c,u]=r.split(" = "),l=new Map;C.value.forEach((m,$)=>{let b=V.value[$]?.[c]?.[u]??0;l.has(m.action)||l.set(m.action,[]),l.get(m.action).push({share:b,step:m})});let p=28,d=t<480,f=Math.max(120,t-(d?120:190)),h=m=>10+m*(f-20),v=[...l].sort((m,$)=>_s(m[1])-_s($[1])).slice(0,14);return a`<div class="strip" ref=${e}>
    <label class="pick">Probability of <select value=${r} onChange=${m=>s(m.target.value)}>
      ${i.map(m=>a`<option value=${m}>${m}</option>`)}</select></label>
    <div class="strip-rows">
      ${v.map(([m,$])=>a`<div class="strip-row" key=${m}>
        <span class="value-name" title=${m}>${Y(m)}</span>
        <svg width=${f} height=${p} role="img" aria-label=${`${m}: chosen at ${$.slice(0,12).map(b=>T(b.share)).join(", ")}`}>
          <line class="rail" x1="10" x2=${f-10} y1=${p/2} y2=${p/2} />
          ${Io($).map(({share:b,at:y})=>a`<circle class=${y.includes(g.value)?"is-now":""} cx=${h(b)} cy=${p/2} r=${Math.min(12,3.5+1.5*Math.sqrt(y.length))} onClick=${()=>U(y[0].step)}><title>${`${T(b)}: ${y.length>1?`${y.length} steps`:`step ${y[0].step}`}`}</title></circle>`)}
        </svg>
      </div>`)}
      <div class="strip-row axis" aria-hidden="true"><span></span><span class="axis-ends" style=${{width:`${f}px`}}><i>0</i><i>½</i><i>1</i></span></div>
    </div>
  </div>`}function Io(e){let t=new Map;for(let{share:n,step:s}of e){let o=Math.round(n*100);t.has(o)||t.set(o,{share:n,at:[]}),t.get(o).at.push(s)}return[...t.values()]}var _s=e=>e.reduce((t,n)=>t+n.share,0)/e.length;var bs=()=>a`<div class="columns">
  <${M} id="all-steps" title="Steps" className="wide"><${Jt} /><//>
  <${M} id="activation" title=${g.value?`Activation of step ${g.value.step}`:"Activation"}><${Lo} /><//>
</div>`,bt=150;function Jt(){let e=de(null),[t,n]=_(!1),s=g.value?.step,o=C.value,i=o.length>bt&&!t,r=i?Math.max(0,Math.min(o.length-bt,Math.round((se.value-bt/2)/25)*25)):0,c=i?o.slice(r,r+bt):o;return k(()=>{let u=e.current?.querySelector("[aria-selected=true]"),l=e.current?.closest(".scroll");u&&l&&(u.offsetTop<l.scrollTop+30||u.offsetTop+u.offsetHeight>l.scrollTop+l.clientHeight)&&(l.scrollTop=u.offsetTop-l.clientHeight/2)},[s]),a`<div class="scroll" tabindex="0" role="region" aria-label="Table of steps">
    <table class="steps">
      <thead><tr><th>Step</th><th>Action</th><th class="num wide-only">Value</th><th>Seen</th><th class="num wide-only">Expected</th><th class="num">Surprise</th><th class="num wide-only">Goal</th></tr></thead>
      <tbody ref=${e}>${c.map(u=>a`<${Uo} key=${u.step} step=${u} isNow=${u.step===s} />`)}</tbody>
    </table>
    ${i&&a`<button class="link" onClick=${()=>n(!0)}>Show all ${o.length} steps</button>`}
  </div>`}var Uo=({step:e,isNow:t})=>a`<tr aria-selected=${t} onClick=${()=>U(e.step)}>
  <td><button class="row-step" aria-label=${`Step ${e.step}`}>${e.step}</button></td>
  <td class="action" title=${e.action}>${Y(e.action)}</td>
  <td class="num wide-only">${H(e.value)}</td>
  <td>${e.status?qe(e)?a`<span class="bad">✕ ${e.status.replace("_"," ")}</span>`:e.seen:a`<span class="muted">running</span>`}</td>
  <td class="num wide-only">${e.status?T(e.expected):""}</td>
  <td class="num">${e.status?a`${ze(e)?a`<span class="mark" aria-label="surprising">▲ </span>`:""}${e.impossible?"∞":W(e.surprise)}`:""}</td>
  <td class="num wide-only">${T((e.endings_after??e.endings)?.goal)}</td>
</tr>`;function Lo(){let e=oe.value,t=g.value;if(!t||!e)return a`<p class="empty">There is no step yet.</p>`;let n=e.observed??e.decided,s=e.observed?.outcome,o=s?(s.ended_ns-s.started_ns)/1e9:null,i=Object.entries(s?.local_variables??{});return a`<div class="activation">
    <p class="big-action">${t.action}</p>
    <dl class="facts">
      <div><dt>Outcome</dt><dd>${s?`${s.status.replace("_"," ")}${s.response?`: ${s.response}`:""}`:"running"}</dd></div>
      ${o!==null&&a`<div><dt>Took</dt><dd>${We(o)}</dd></div>`}
      <div><dt>Decided in</dt><dd>${We(n.planning_s)}${n.planner?`, by ${n.planner}`:""}</dd></div>
      ${n.why&&a`<div><dt>Why this planner</dt><dd>${n.why}</dd></div>`}
      <div><dt>Look-ahead</dt><dd>${n.horizon} decisions</dd></div>
      <div><dt>Model</dt><dd>revision ${n.revision}, <code>${n.model_digest.slice(0,12)}</code></dd></div>
      <div><dt>Belief</dt><dd>${n.belief.states.toLocaleString("en")} ${n.belief.states===1?"state":"states"}, ${n.belief.is_exact?"exact":"sampled"}</dd></div>
      ${Object.entries(s?.numbers??{}).map(([r,c])=>a`<div><dt>${r}</dt><dd>${JSON.stringify(c)}</dd></div>`)}
      ${Object.entries(s?.monitors??{}).map(([r,c])=>a`<div><dt>${r}</dt><dd>${c}</dd></div>`)}
    </dl>
    <h3>Local variables</h3>
    ${i.length?a`<dl class="facts mono">${i.map(([r,c])=>a`<div><dt>${r}</dt><dd>${c}</dd></div>`)}</dl>`:a`<p class="empty">${s?"The mapping has none.":"They come with the outcome."}</p>`}
  </div>`}function ys(){let[e,t]=_(null),[n,s]=_(null),[o,i]=_(""),r=g.value,c=r?.revision??0,{name:u}=w.value;if(k(()=>{let h=!0;return R(`/v1/missions/${encodeURIComponent(u)}/documents?revision=${c}`).then(v=>h&&(t(v),s(null)),v=>h&&s(v)),()=>h=!1},[u,c,!!I.value]),k(()=>i(""),[r?.skill]),n)return a`<${A} problem=${n} />`;if(!e)return a`<p class="empty">Reading the documents…</p>`;let l=(e.skills[r?.skill]??[]).filter(h=>h.what==="model"||h.what===`rule ${r?.seen}`),p=o||l[0]?.file||e.files[0]?.name,d=e.files.find(h=>h.name===p)?.text??"",f=l.map(h=>h.file);return a`<${M} id="documents" title=${`Documents of ${e.project}`} note=${`Revision ${e.revision}${r?`; the lines of ${r.skill} are marked`:""}.`}>
    <div class="files" role="tablist" aria-label="Files">
      ${e.files.map(h=>a`<button role="tab" aria-selected=${h.name===p} class=${f.includes(h.name)?"is-about":""} onClick=${()=>i(h.name)}>${h.name}</button>`)}
    </div>
    <${Ho} key=${p} text=${d} marked=${l.filter(h=>h.file===p)} />
  <//>`}function Ho({text:e,marked:t}){let n=de(null);return k(()=>{let s=n.current?.querySelector(".is-marked");s&&(n.current.scrollTop=Math.max(0,s.offsetTop-60))},[t.map(s=>s.first).join()]),a`<pre class="source" ref=${n} tabindex="0"><code>${e.split(`
`).map((s,o)=>{let i=t.find(r=>r.first<=o+1&&o+1<=r.last);return a`<span class=${i?"line is-marked":"line"} data-line=${o+1}>${s||" "}\n</span>`})}</code></pre>`}function ws(){let[e,t]=_(null),{name:n}=w.value,s=g.value?.step,o=!!g.value?.status;return k(()=>{if(!Se.value||!s)return;let i=!0,r=l=>i&&t(l),c=`/v1/missions/${encodeURIComponent(n)}/decisions/${s}/picture`,u=setTimeout(()=>In(c).then(l=>r({step:s,url:URL.createObjectURL(l)}),l=>r({step:s,problem:l})),150);return()=>{i=!1,clearTimeout(u)}},[n,s,o,Se.value]),k(()=>()=>e?.url&&URL.revokeObjectURL(e.url),[e]),Se.value?a`<${M} id="drawn" title="State" note="The likeliest value of each variable, as the bundle draws it.">
    <${A} problem=${e?.problem} />
    ${e?.url&&a`<figure class="picture"><img src=${e.url} alt=${`The state after step ${e.step}`} /></figure>`}
  <//>`:null}function xs(){let e=I.value,[t,n]=_(null),[s,o]=_(null),[i,r]=_([]),[c,u]=_(""),[l,p]=_(""),[d,f]=_(null),h=e&&encodeURIComponent(e.run);k(()=>{h&&(R(`/v1/runs/${h}`).then(n,f),R(`/v1/runs/${h}/services`).then(o,f),R(`/v1/runs/${h}/bundles`).then($=>r($.entries),()=>r([])))},[h,Ie.value.length,me.value.size]);let v=s?.services.find($=>$.service==="solver")?.service??s?.services[0]?.service,m=c||v;return k(()=>{if(!h||!m)return;let $=()=>Un(`/v1/runs/${h}/logs/${m}?tail=60000`).then(p,f);$();let b=e.is_running?setInterval($,2e3):null;return()=>clearInterval(b)},[h,m,e?.is_running]),e?a`<div class="columns">
    <${M} id="logs" title="Logs" className="wide">
      <div class="files" role="tablist" aria-label="Processes">
        ${(s?.services??[]).map($=>a`<button role="tab" aria-selected=${$.service===m} onClick=${()=>u($.service)}>
          ${e.is_running&&a`<i class=${`presence ${me.value.get($.service)?"is-there":""}`} title=${me.value.get($.service)?"on the bus":"not on the bus"}></i>`}${$.service}</button>`)}
      </div>
      <pre class="source log" tabindex="0" aria-label=${`Log of ${m}`}>${l||"The log is empty."}</pre>
      <${A} problem=${d} />
    <//>
    <div class="stack">
      <${M} id="run" title="Run">
        ${t&&a`<dl class="facts">
          <div><dt>Robot</dt><dd>${t.robot}</dd></div>
          <div><dt>Started</dt><dd>${mt(t.started)}</dd></div>
          <div><dt>Deploy file</dt><dd class="path">${t.deploy_file}</dd></div>
          <div><dt>Directory</dt><dd class="path">${t.directory}</dd></div>
          <div><dt>Seed</dt><dd>${e.mission?.seed??t.seed}</dd></div>
          ${t.is_played&&a`<div><dt>Skills</dt><dd>played by their documents</dd></div>`}
          ${t.sandbox&&a`<div><dt>Documents</dt><dd>${t.sandbox}</dd></div>`}
        </dl>`}
        ${(s?.ends??[]).map($=>a`<p class="aside"><b>${$.name}</b> ended after ${$.after_s.toFixed(1)} s, ${$.how}: ${$.then}</p>`)}
      <//>
      <${M} id="bundles" title="Documents">
        <ul class="bundles">${i.map($=>a`<li><b>${$.project}</b> revision ${$.revision}<span class="muted">${$.skills.join(", ")}</span></li>`)}</ul>
        ${e.is_running&&a`<${Wo} run=${e.run} />`}
      <//>
    </div>
  </div>`:null}function Wo({run:e}){let[t,n]=_(null),[s,o]=_("");async function i(r){let c=r.target.files[0];if(c){o(`Sending ${c.name}…`),n(null);try{let u=await ut(`/v1/runs/${encodeURIComponent(e)}/bundles`,c),l=[...u.added??[],...u.changed??[]].join(", ");o(`Accepted: revision ${u.revision}${l?`, ${l}`:", nothing new"}.`)}catch(u){o(""),n(u)}r.target.value=""}}return a`<div class="push">
    ${q()?a`<label class="button">Give it documents…<input type="file" class="visually-hidden" onChange=${i} accept=".zip,.tar,.gz,.tgz,.xz,.bz2,.ef,.sd,.am,.lf,.json" /></label>
          <p class="note">A document, or an archive of some. They take over at a decision, and the mission goes on.</p>`:a`<p class="note">Open the address that <code>aos serve</code> prints to change something here.</p>`}
    <p role="status">${s}</p>
    <${A} problem=${t} />
  </div>`}var zo={overview:"Overview",why:"Why",steps:"Steps",model:"Model",documents:"Documents",system:"System"},qo={overview:Go,why:$s,steps:bs,model:gs,documents:ys,system:xs};function ks(){let{name:e,view:t}=w.value;k(()=>(ht(e),zn),[e]);let n=g.value?.step,s=g.value&&!g.value.status;if(k(()=>{if(!n)return;let i=setTimeout(()=>Bn(n),60);return()=>clearTimeout(i)},[e,n,s]),X.value&&!I.value)return a`<main id="main" class="page"><h1>${e}</h1><${A} problem=${X.value} /><p><a href="#/">All missions</a></p></main>`;let o=qo[t];return a`<main id="main" class="page">
    <${Bo} />
    <${ts} />
    <div class="hero card">
      <${is} />
      <${os} />
    </div>
    <nav class="views" aria-label="Views">
      ${It.map(i=>a`<a href=${P(e,i,w.value.step)} aria-current=${i===t?"page":null}>${zo[i]}</a>`)}
    </nav>
    <${o} />
  </main>`}function Bo(){let e=I.value,t=O.value,n=t?.phase==="ended",s=g.value&&($e.value||g.value===Le.value?g.value.endings_after??g.value.endings:g.value.endings_after??g.value.endings),o=s?.goal??t?.goal_probability;return a`<header class="head">
    <div class="head-name">
      <h1>${e?.robot??" "}</h1>
      <p class="muted">${w.value.name}</p>
    </div>
    <div class="head-state">
      <p class=${`phase is-${n?t.ending:t?.phase??"waiting"}`} role="status">
        <i class=${n||!e?.is_running?"still-dot":"pulse"}></i>${n?vt(t.ending):Kn(t?.phase??"waiting")}
        ${!$e.value&&a`<span class="past">showing step ${g.value?.step}</span>`}
      </p>
      <p class="remark">${t?.remark??""}</p>
      <${Vo} />
    </div>
    <div class="goal" title="How probable the goal is, as the belief has it">
      <span class="goal-number">${T(o)}</span><span class="goal-word">goal</span>
      <svg viewBox="0 0 100 4" preserveAspectRatio="none" aria-hidden="true"><rect width="100" height="4" class="goal-rail" /><rect width=${(o??0)*100} height="4" class="goal-bar" /></svg>
      ${s?.failure>5e-4&&a`<span class="failure">failure ${T(s.failure)}</span>`}
    </div>
    <${Qn} />
  </header>`}function Vo(){let e=[...new Set(pt.value.map(s=>s.skill))];if(!e.length)return null;let{name:t,step:n}=w.value;return a`<p><a class="alarm" href=${P(t,"model",n)}><svg width="11" height="11" viewBox="0 0 10 10" aria-hidden="true"><path d="M5 0 l5 9.5 h-10z" /></svg>The model of ${e.join(", ")} does not hold</a></p>`}function Go(){return a`<div class="columns overview">
    <div class="stack">
      <${M} id="belief" title="Belief" note=${Ko()}><${us} /><//>
      <${ws} />
      <${M} id="all-steps" title="Steps"><${Jt} /><//>
    </div>
    <div class="stack">
      <${M} id="values" title="Values of the actions"><${ps} /><${es} /><//>
      ${J.value.length>0&&a`<${M} id="world" title="World"><${Jo} /><//>`}
    </div>
  </div>`}var Ko=()=>V.value.length?`After ${$e.value?"the newest step":`step ${g.value?.step}`}.`:"";function Jo(){let e=J.value,t=g.value?.step??0,n=e.filter(s=>s<=t).at(-1)??e[0];return n===void 0?null:a`<figure class="picture"><img src=${`/v1/missions/${encodeURIComponent(w.value.name)}/world/${n}`} alt=${`The world after step ${n}`} />
    <figcaption class="note">After step ${n}</figcaption></figure>`}var Zt="aos-theme",Ss=e=>e?document.documentElement.dataset.theme=e:delete document.documentElement.dataset.theme;Ss(localStorage.getItem(Zt));var Zo={live:"Live",lost:"Connection lost, trying again",connecting:"Connecting",over:"Recorded"};function Xo(){let{kind:e,name:t}=w.value,n=e==="missions"&&t;return k(()=>{e==="runs"&&t?Qo(t):n||(He(),ft())},[e,t]),a`
    <a class="skip" href="#main" onClick=${s=>{s.preventDefault(),document.getElementById("main")?.focus()}}>To the content</a>
    <header class="bar">
      <a class="brand" href="#/" aria-label="AOS, all missions"><svg viewBox="0 0 32 32" width="22" height="22" aria-hidden="true"><rect width="32" height="32" rx="8" /><path d="M6 21c5 0 5-10 10-10s5 10 10 10" /><circle cx="16" cy="11" r="3.2" /></svg><span>AOS</span></a>
      ${n&&a`<nav aria-label="Place"><a href="#/">Missions</a></nav>`}
      <span class="room"></span>
      <span class=${`connection is-${Z.value}`} role="status"><i></i>${n||Z.value==="lost"?Zo[Z.value]:""}</span>
      <${Yo} />
    </header>
    ${n?a`<${ks} key=${t} />`:a`<${Zn} />`}`}async function Qo(e){await He();let t=(ke.value??[]).find(n=>n.run===e);le(P(t?.missions?.at(-1)??e),{replace:!0})}function Yo(){let[e,t]=_(localStorage.getItem(Zt)??""),n=e?e==="dark":matchMedia("(prefers-color-scheme: dark)").matches;function s(){let o=n?"light":"dark";localStorage.setItem(Zt,o),Ss(o),t(o)}return a`<button class="quiet theme" onClick=${s} aria-label=${n?"Light colours":"Dark colours"} title=${n?"Light colours":"Dark colours"}>${n?"☀":"☾"}</button>`}addEventListener("keydown",e=>{if(!(e.target instanceof Element&&e.target.closest("input, select, textarea, .scroll, .source, [role=tab]")||e.ctrlKey||e.metaKey||e.altKey||!g.value)){if(e.key==="ArrowLeft")U(g.value.step-1);else if(e.key==="ArrowRight")U(g.value.step+1);else if(e.key==="Home")U(C.value[0].step);else if(e.key==="End")U(null);else return;e.preventDefault()}});await Ln();Tt(a`<${Xo} />`,document.getElementById("page"));
